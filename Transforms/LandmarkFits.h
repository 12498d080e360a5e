#pragma once

#include <optional>
#include <span>

#include "Transforms/AffineTransform.h"
#include "Transforms/RigidTransform.h"
#include "Transforms/SimilarityTransform.h"
#include "Transforms/SplineTransform.h"

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

/// The similarity with the least sum of squared distances, about the fixed landmarks' mean.
///
/// Source: Umeyama as above, with scaling.
/// @throws InvalidInput as fit_rigid().
template <int Dim>
SimilarityTransform<Dim> fit_similarity(std::span<const Point<Dim>> fixed,
                                        std::span<const Point<Dim>> moving);

/// The affine map with the least sum of squared distances, about the fixed landmarks' mean.
/// @throws InvalidInput unless at least Dim + 1 fixed landmarks are not all on one line (2D) or plane
/// (3D), and all are finite.
template <int Dim>
AffineTransform<Dim> fit_affine(std::span<const Point<Dim>> fixed,
                                std::span<const Point<Dim>> moving);

/// The thin-plate spline through landmarks, or near to those with an uncertainty: of all maps the one with
/// the least
///
///     sum_j |T(p_j) - q_j|^2 / s_j^2 + lambda int sum_ab |T_,ab|^2 dx   over the whole plane or space,
///
/// where landmarks without uncertainty, s_j = 0, are met exactly. It is a SplineTransform on a
/// ThinPlateBasis whose centres are the fixed landmarks, in closed form: one dense system, O(n^3).
///
/// @param sigma_mm  s_j >= 0, one per pair; empty: all are exact.
/// @param lambda    no unit in 2D, 1/mm in 3D, 0 or more. Not given: the largest for which the soft
///                  landmarks are missed by no more than their uncertainty, sum_j |T(p_j) - q_j|^2 / s_j^2 = Dim
///                  times their number, to a hundredth (C. H. Reinsch, "Smoothing by Spline Functions",
///                  1967).
/// Sources: F. L. Bookstein, "Principal Warps", IEEE TPAMI 11(6), 1989; G. Wahba, "Spline Models for
/// Observational Data", SIAM, 1990, 2.4.
/// @throws InvalidInput when the numbers differ, a number is not finite or negative, or as ThinPlateBasis:
/// fixed landmarks that coincide (the message names the pair) or lie on one line (2D) or plane (3D).
template <int Dim>
SplineTransform<Dim> fit_thin_plate(std::span<const Point<Dim>> fixed,
                                    std::span<const Point<Dim>> moving,
                                    std::span<const double> sigma_mm = {},
                                    std::optional<double> lambda = std::nullopt);

}  // namespace crease
