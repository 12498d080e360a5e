#pragma once

#include <memory>
#include <vector>

#include "Transforms/AffineMap.h"
#include "Transforms/BoundGrid.h"
#include "Transforms/Splines/QuasiInterpolation.h"
#include "Transforms/Transform.h"

namespace crease {

/// Any transform on the samples of a raster, through its values at the nodes of a lattice: what it adds to an
/// affine map is quasi-interpolated by a cubic B-spline (QuasiInterpolation), which a bound grid maps
/// row by row and takes the adjoint of. So a pass costs one value per node, whatever the transform, and no
/// loop over samples times parameters.
///
/// The error is that of the interpolation: none for polynomials of degree 3, some span^4 times the
/// fourth derivatives else; for elastic bodies, with a quarter of their centres' distance, where these move
/// independently of each other, 0.7 % of their movement, root mean square, and 6 % at most. The transform is asked for up to two spans beyond the raster.
template <int Dim>
class TransformLattice {
 public:
  /// @param span  of the lattice, mm: a quarter of the distance over which the transform varies, or less.
  TransformLattice(const Raster<Dim>& raster, double span);

  /// The lattice's spline bound to the raster.
  const std::shared_ptr<const BoundGrid<Dim>>& grid() const { return grid_; }
  /// The control points of T - A, Dim x num_control_points of the grid.
  ControlPoints<Dim> control_points(const Transform<Dim>& transform,
                                    const AffineMap<Dim>& affine) const;
  /// Adds to the transform's gradient what a gradient by those control points means for its parameters.
  void add_adjoint(const Transform<Dim>& transform, const ControlPoints<Dim>& by_control_points,
                   Eigen::Ref<Eigen::VectorXd> gradient) const;

 private:
  QuasiInterpolation<Dim> interpolation_;
  std::vector<Point<Dim>> nodes_;
  std::shared_ptr<const BoundGrid<Dim>> grid_;
};

extern template class TransformLattice<2>;
extern template class TransformLattice<3>;

}  // namespace crease
