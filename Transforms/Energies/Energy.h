#pragma once

#include "Core/Point.h"
#include "Transforms/BlockHessian.h"

namespace crease {

/// A differentiable function of a spline transform's control points: bending, rigidity, elasticity.
/// It needs no image. T(x) = A(x) + u(x), u = sum_i phi_i B_i; the argument is phi (Dim x n, mm).
template <int Dim>
class Energy {
 public:
  virtual ~Energy() = default;
  /// The energy at phi; adds `scale` times its gradient (Dim x n) and its Hessian (exact where it is
  /// positive semi-definite by nature, else Gauss-Newton's) where these are not null.
  virtual double evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                          ControlPoints<Dim>* gradient, BlockHessian<Dim>* hessian) const = 0;
};

}  // namespace crease
