#pragma once

#include <array>

#include "Transforms/AffineMap.h"
#include "Transforms/Splines/SplineBasis.h"
#include "Transforms/Transform.h"

namespace crease {

/// T(x) = A(x) + u(x), u(x) = sum_i phi_i B_i(x): an affine map that stays as it is, and a spline that
/// carries only what the affine map does not.
///
/// Parameters are the control points phi (OutDim x n, mm), control point by control point: parameter
/// OutDim * i + a is coordinate a of phi_i. They start at zero, so that T = A.
///
/// Outside the domain u goes on from the domain's nearest point p, no farther along its gradient than a
/// quarter of a mesh edge (Continuation). There `spatial_jacobian` leaves out how grad u(p) changes with p, and the
/// second derivatives are those of p.
///
/// Source: dissertation, (3.1).
template <int InDim, int OutDim = InDim>
class SplineTransform final : public Transform<InDim, OutDim> {
 public:
  using Affine = AffineMap<InDim, OutDim>;

  /// @throws InvalidInput when the basis is null or the affine map not finite.
  explicit SplineTransform(std::shared_ptr<const SplineBasis<InDim>> basis,
                           const Affine& affine = {});

  const SplineBasis<InDim>& basis() const { return *basis_; }
  std::shared_ptr<const SplineBasis<InDim>> shared_basis() const { return basis_; }
  const Affine& affine() const { return affine_; }
  const ControlPoints<OutDim>& control_points() const { return control_points_; }
  /// @throws InvalidInput when there are not as many columns as functions or an entry is not finite.
  void set_control_points(const Eigen::Ref<const ControlPoints<OutDim>>& control_points);

  /// Entry a is d^2 T_a / dx^2 at x: InDim x InDim, symmetric, 1/mm.
  std::array<Matrix<InDim>, OutDim> second_derivatives(const Point<InDim>& x) const;

  std::unique_ptr<Transform<InDim, OutDim>> clone() const override;
  Point<OutDim> map(const Point<InDim>& x) const override;
  Matrix<OutDim, InDim> spatial_jacobian(const Point<InDim>& x) const override;
  typename Transform<InDim, OutDim>::Sample sample(const Point<InDim>& x) const override;
  std::unique_ptr<TransformSampler<InDim, OutDim>> sampler() const override;
  bool in_domain(const Point<InDim>& x) const override { return basis_->contains(x); }
  Eigen::Index num_parameters() const override { return control_points_.size(); }
  Eigen::VectorXd parameters() const override;
  void set_parameters(const Eigen::Ref<const Eigen::VectorXd>& parameters) override;
  void add_adjoint(std::span<const Point<InDim>> x, std::span<const Vector<OutDim>> forces,
                   Eigen::Ref<Eigen::VectorXd> gradient) const override;
  bool linear_in_parameters() const override { return true; }

 private:
  struct Jet;
  Jet displacement(const Point<InDim>& p, int derivatives) const;

  std::shared_ptr<const SplineBasis<InDim>> basis_;
  double edge_length_;  // the mean one, mm
  Affine affine_;
  ControlPoints<OutDim> control_points_;
  std::shared_ptr<const SplineSum<InDim>> sum_;  // null: the basis offers none
};

extern template class SplineTransform<2, 2>;
extern template class SplineTransform<3, 3>;
extern template class SplineTransform<2, 3>;

}  // namespace crease
