#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "Transforms/BlockHessian.h"

namespace crease {

/// Adds springs between all control points that couple, weak beside everything else: they hold what no
/// energy sees, the interior of bodies and affine maps.
/// @param stiffness  one entry per pair of the pattern.
void add_springs(const HessianPattern& pattern, std::vector<double>& stiffness);

/// The entries (i, k), k <= i, as the lower triangle of a symmetric matrix, compressed, times the identity
/// of `copies` (each control point's coordinates side by side).
Eigen::SparseMatrix<double> lower_triangle(const HessianPattern& pattern,
                                           const std::vector<double>& entries, int copies = 1);

}  // namespace crease
