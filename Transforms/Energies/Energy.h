#pragma once

#include <span>

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

  /// Whether its Hessian couples the coordinates of control points.
  virtual bool couples_coordinates() const { return false; }

  /// A convex stand-in that is quadratic and treats all coordinates alike, from which a minimisation
  /// starts: 1/2 sum_j phi_j^T K phi_j - <b(phi0), phi>. Here `scale` times K is added to the entries of
  /// the pattern. An energy without a stand-in adds nothing.
  virtual void add_stiffness(double scale, const HessianPattern& pattern,
                             std::span<double> stiffness) const;
  /// Adds scale * b(phi0) (Dim x n). Returns whether b depends on phi0, so that it is worth renewing.
  virtual bool add_pull(const Eigen::Ref<const ControlPoints<Dim>>& phi0, double scale,
                        ControlPoints<Dim>& pull) const;
};

template <int Dim>
void Energy<Dim>::add_stiffness(double, const HessianPattern&, std::span<double>) const {}

template <int Dim>
bool Energy<Dim>::add_pull(const Eigen::Ref<const ControlPoints<Dim>>&, double,
                           ControlPoints<Dim>&) const {
  return false;
}

}  // namespace crease
