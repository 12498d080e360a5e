#pragma once

#include <cstdint>
#include <vector>

#include "Core/Raster.h"
#include "Transforms/Transform.h"

namespace crease {

/// Solves T(x) = y: damped Newton steps from the sample of a grid whose image lies nearest to y, steps no
/// longer than a few cells; where Newton fails, the fixed point x <- x - (T(x) - y), from there or from y:
/// beyond a displacement field, where T is the identity, that is y itself.
///
/// The grid should be fine enough that T is nearly affine in a cell. Building it maps every sample once.
template <int Dim>
class InverseMap {
 public:
  /// @param transform  must stay alive as long as this.
  /// @param grid       starting points in the transform's domain, for example the fixed raster.
  /// @throws InvalidInput when the grid is empty.
  InverseMap(const Transform<Dim>& transform, const Raster<Dim>& grid);

  /// x with |T(x) - y| < 1e-7 of the grid's spacing; NaN when none was found (a fold, a gap).
  Point<Dim> operator()(const Point<Dim>& y) const;

 private:
  std::int64_t nearest_sample(const Point<Dim>& y) const;
  std::array<int, Dim> bin_of(const Point<Dim>& y) const;
  Point<Dim> newton(const Point<Dim>& y, Point<Dim> x) const;
  Point<Dim> fixed_point(const Point<Dim>& y, Point<Dim> x) const;

  const Transform<Dim>& transform_;
  Raster<Dim> grid_;
  ControlPoints<Dim> mapped_;  // T of the grid's samples
  Box<Dim> box_;               // of the mapped samples, cut into bins
  std::array<int, Dim> num_bins_{};
  std::vector<int> bin_start_;  // per bin, into bin_samples_
  std::vector<std::int64_t> bin_samples_;
  double tolerance_;
};

/// Inverse displacements on a raster.
template <int Dim>
struct InverseField {
  ControlPoints<Dim> displacements;  ///< T^-1(y) - y per sample y, mm; NaN where unresolved
  std::int64_t num_unresolved = 0;
};

/// @param wanted  the samples y (in the moving image's space). In parallel.
template <int Dim>
InverseField<Dim> invert(const Transform<Dim>& transform, const Raster<Dim>& grid,
                         const Raster<Dim>& wanted);

extern template class InverseMap<2>;
extern template class InverseMap<3>;

}  // namespace crease
