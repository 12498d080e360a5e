#pragma once

#include "Transforms/Splines/TensorBSplineBasis.h"

namespace crease {

/// Cubic B-splines on a lattice, near to functions of which the values at its nodes are known:
///
///     c_j = -1/6 f(x_{j-1}) + 4/3 f(x_j) - 1/6 f(x_{j+1})   along every axis
///
/// with x_j the Greville points. It reproduces cubic polynomials, is local, and its error is of the order
/// (span)^4 |f''''| where f is smooth.
/// Source: C. de Boor, "A Practical Guide to Splines", 1978, chapter XII.
template <int Dim>
class QuasiInterpolation {
 public:
  /// @param span  size of the lattice's spans, mm; their number is rounded so that they cover the raster.
  QuasiInterpolation(const Raster<Dim>& raster, double span);

  const TensorBSplineBasis<Dim>& basis() const { return basis_; }
  /// Where values are needed, one column each, mm: the Greville points and one more on every side.
  const ControlPoints<Dim>& nodes() const { return nodes_; }
  /// Control points from values: rows x nodes to rows x control points.
  Eigen::MatrixXd control_points(const Eigen::Ref<const Eigen::MatrixXd>& values) const;
  /// Its transpose: rows x control points to rows x nodes.
  Eigen::MatrixXd adjoint(const Eigen::Ref<const Eigen::MatrixXd>& gradient) const;

 private:
  TensorBSplineBasis<Dim> basis_;
  std::array<int, Dim> node_size_;
  ControlPoints<Dim> nodes_;
};

extern template class QuasiInterpolation<2>;
extern template class QuasiInterpolation<3>;

}  // namespace crease
