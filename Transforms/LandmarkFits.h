#pragma once

#include <span>

#include "Transforms/AffineTransform.h"
#include "Transforms/RigidTransform.h"

namespace crease {

/// The rigid map with the least sum of |T(fixed_j) - moving_j|^2, about the fixed landmarks' mean.
///
/// Source: S. Umeyama, "Least-squares estimation of transformation parameters between two point
/// patterns", IEEE TPAMI 13(4), 1991 (without scaling).
/// @throws InvalidInput unless at least 2 landmarks are distinct (2D), or 3 not on one line (3D), in
/// both images, and all are finite.
template <int Dim>
RigidTransform<Dim> fit_rigid(std::span<const Point<Dim>> fixed,
                              std::span<const Point<Dim>> moving);

/// The affine map with the least sum of squared distances, about the fixed landmarks' mean.
/// @throws InvalidInput unless at least Dim + 1 fixed landmarks are not all on one line (2D) or plane
/// (3D), and all are finite.
template <int Dim>
AffineTransform<Dim> fit_affine(std::span<const Point<Dim>> fixed,
                                std::span<const Point<Dim>> moving);

}  // namespace crease
