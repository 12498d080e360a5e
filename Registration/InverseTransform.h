#pragma once

#include <cstdint>
#include <span>

#include "Core/Box.h"
#include "Images/Resample.h"
#include "Transforms/Transform.h"

namespace crease {

/// T^-1 of any transform: affine and rigid maps, and chains of these, by the inverse matrix; chains part by
/// part, the last part first; all others by Newton's method (InverseMap) started from samples of a grid,
/// namely
///
///     SplineTransform             its domain's box, a quarter of its edge length apart
///     DisplacementFieldTransform  its own samples
///     any other                   the box of the points that are asked for, grown by half
///
/// so that |T(T^-1(y)) - y| < 1e-6 of the grid's spacing.
///
/// @param transform  must stay alive as long as the result.
/// @param where      holds the points y that will be asked for, mm; may be empty if no part is of another
///                   class.
/// @return           a map whose values are NaN where no inverse was found: a fold, or a point that the
///                   domain's image does not cover. It may be called from several threads.
/// @throws InvalidInput when an affine part is singular, or a box is needed and empty.
template <int Dim>
PointMap<Dim> inverse_transform(const Transform<Dim>& transform, const Box<Dim>& where = {});

/// What T(T^-1(y)) = y lacks over some points y.
struct InverseResidual {
  std::int64_t resolved = 0;
  std::int64_t unresolved = 0;  ///< points without an inverse; they do not count below
  double sum_mm = 0;            ///< of |T(T^-1(y)) - y|
  double max_mm = 0;

  double mean_mm() const { return resolved == 0 ? 0 : sum_mm / static_cast<double>(resolved); }
  InverseResidual& operator+=(const InverseResidual& other);
};

/// x_k = inverse(y_k), in parallel; the same bits on any number of threads.
/// @param x  as many as y. @throws InvalidInput when it is not.
template <int Dim>
InverseResidual invert_points(const Transform<Dim>& transform, const PointMap<Dim>& inverse,
                              std::span<const Point<Dim>> y, std::span<Point<Dim>> x);

extern template PointMap<2> inverse_transform<2>(const Transform<2>&, const Box<2>&);
extern template PointMap<3> inverse_transform<3>(const Transform<3>&, const Box<3>&);
extern template InverseResidual invert_points<2>(const Transform<2>&, const PointMap<2>&,
                                                 std::span<const Point<2>>, std::span<Point<2>>);
extern template InverseResidual invert_points<3>(const Transform<3>&, const PointMap<3>&,
                                                 std::span<const Point<3>>, std::span<Point<3>>);

}  // namespace crease
