#pragma once

#include <memory>
#include <optional>

#include "Transforms/AffineMap.h"
#include "Transforms/Splines/CardinalSystem.h"
#include "Transforms/Transform.h"

namespace crease {

/// Poisson's ratio of a body that is neither very compressible nor nearly incompressible.
inline constexpr double kPoissonRatio = 0.3;

/// The elastic body spline: T(x) = A(x) + u(x), where A stays as it is and u is a displacement of an
/// endless elastic body that takes given values at n centres c_i,
///
///     u(x) = sum_i G(x - c_i) w_i + B x + b,   G(x) = (alpha |x|^2 I - 3 x x^T) |x|,
///     alpha = 12 (1 - nu) - 1 in space, 10 (1 - nu) - 1 in the plane (plane strain).
///
/// G e solves Navier's equation mu div grad u + (lambda + mu) grad div u = -f for the force
/// f = -2 m mu (1 - nu) |x| e, m = 72 in space and 45 in the plane, nu = lambda / (2 (lambda + mu)): Galerkin's
/// vector g e with g = |x|^5 / 5, u = 2 (1 - nu) div grad g e - grad (e . grad g). Stretching in one direction
/// thus contracts across, unlike with thin plates, which treat each coordinate by itself.
///
/// G is conditionally positive definite, so that the w_i follow from values at the centres in closed form
/// (CardinalSystem, with all affine B x + b), affine displacements are reproduced everywhere, and u has
/// the least
///
///     roughness(u) = (2 pi)^-Dim int |k|^(Dim + 3) (|U|^2 + |k/|k| . U|^2 / (1 - 2 nu)) dk, U the Fourier
///
/// transform of u; in space that is int |grad div grad u|^2 + |div grad div u|^2 / (1 - 2 nu) dx.
///
/// Parameters: u at the centres (Dim x n, mm), centre by centre; they start at zero, so that T = A. T is
/// linear in them.
///
/// Cost: O(n^3) once per set of centres, which transforms share, O(n) for a point.
/// Source: M. H. Davis, A. Khotanzad, D. P. Flamig, S. E. Harms, "A Physics-Based Coordinate
/// Transformation for 3-D Image Matching", IEEE TMI 16(3), 1997 (in space; the plane by the same steps).
template <int Dim>
class CauchyNavierTransform final : public Transform<Dim> {
 public:
  /// @param centres        mm, Dim + 1 to kMostCentres / Dim.
  /// @param poisson_ratio  nu, above -1 and below 0.5.
  /// @throws InvalidInput for another ratio, an affine map that is not finite, or as CentreFrame: the
  /// message names the centres that coincide.
  explicit CauchyNavierTransform(const ControlPoints<Dim>& centres,
                                 double poisson_ratio = kPoissonRatio,
                                 const AffineMap<Dim>& affine = {});

  const ControlPoints<Dim>& centres() const;
  double poisson_ratio() const;
  const AffineMap<Dim>& affine() const { return affine_; }
  /// u at the centres, mm.
  const ControlPoints<Dim>& displacements() const { return displacements_; }
  /// Values f at the centres of the smoothest displacement near to given values y: the f with the least
  /// sum_i |f_i - y_i|^2 / v_i + roughness; f_i = y_i where v_i = 0.
  /// @param variances  v_i >= 0, mm^3.
  ControlPoints<Dim> smoothed(const ControlPoints<Dim>& values,
                              const Eigen::Ref<const Eigen::VectorXd>& variances) const;

  std::unique_ptr<Transform<Dim>> clone() const override;
  Point<Dim> map(const Point<Dim>& x) const override;
  Matrix<Dim> spatial_jacobian(const Point<Dim>& x) const override;
  Eigen::Index num_parameters() const override { return displacements_.size(); }
  Eigen::VectorXd parameters() const override;
  void set_parameters(const Eigen::Ref<const Eigen::VectorXd>& parameters) override;
  void add_adjoint(std::span<const Point<Dim>> x, std::span<const Vector<Dim>> forces,
                   Eigen::Ref<Eigen::VectorXd> gradient) const override;
  /// One matrix product; at a centre exactly that centre's unit columns.
  Eigen::MatrixXd parameter_jacobian(std::span<const Point<Dim>> x) const override;
  bool linear_in_parameters() const override { return true; }
  /// R with roughness(u) = p^T R p; 1/mm^3.
  std::optional<Eigen::MatrixXd> roughness_matrix() const override;

 private:
  struct Body;
  void bind();

  std::shared_ptr<const Body> body_;  // what depends on centres and ratio alone
  AffineMap<Dim> affine_;
  ControlPoints<Dim> displacements_;
  ControlPoints<Dim> weights_;  // w, in the body's frame
  Matrix<Dim, Dim + 1> b_;      // b and B, likewise
};

extern template class CauchyNavierTransform<2>;
extern template class CauchyNavierTransform<3>;

}  // namespace crease
