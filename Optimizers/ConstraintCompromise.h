#pragma once

#include <span>

#include "Optimizers/LinearConstraints.h"

namespace crease {

/// Replaces rows that contradict each other by equations that they agree on as well as they can.
///
/// With U S V^T the singular value decomposition of these rows, the equations are V_k^T Phi = S_k^-1 U_k^T d
/// for all S_k of at least `least_share` times the largest norm of a row: a Phi that meets them has the
/// least |C Phi - d| that these directions allow. Directions of smaller S_k are left free. There the rows
/// nearly cancel each other, so that their contradictions would be magnified by 1 / S_k.
///
/// @param rows  numbers of the rows to replace, each once. The other rows keep their order and come first.
/// @param least_share  0 keeps all directions but those of rounding: the plain least-squares solution.
LinearConstraints compromise(const LinearConstraints& constraints, std::span<const int> rows,
                             double least_share);

}  // namespace crease
