#include "Transforms/SplineTransform.h"

#include "Core/Error.h"
#include "Transforms/ParameterCheck.h"
#include "Transforms/Splines/Continuation.h"
#include "Transforms/Splines/SplineSampler.h"
#include "Transforms/TransformSampler.h"

namespace crease {
namespace {

/// Weights w with u(x) = sum_i w_i phi_i inside and outside the domain.
template <int Dim>
BasisValues<Dim> continued(const SplineBasis<Dim>& basis, double edge_length, const Point<Dim>& x) {
  if (basis.contains(x)) return basis.evaluate(x);
  const Point<Dim> p = basis.nearest_point(x);
  auto at_p = basis.evaluate(p, 1);
  at_p.values += at_p.gradients.transpose() * Continuation<Dim>(x - p, edge_length).step;
  return at_p;
}

/// The affine map and what the spline adds.
template <int InDim, int OutDim>
class SplineTransformSampler final : public TransformSampler<InDim, OutDim> {
 public:
  using typename TransformSampler<InDim, OutDim>::Sample;
  SplineTransformSampler(const AffineMap<InDim, OutDim>& affine,
                         std::unique_ptr<SplineSampler<InDim>> spline)
      : affine_(affine), spline_(std::move(spline)) {}

  void sample(std::span<const Point<InDim>> x, std::span<Sample> samples) const override {
    Eigen::MatrixXd jets(OutDim * (1 + InDim), static_cast<Eigen::Index>(x.size()));
    std::vector<std::uint8_t> inside(x.size());
    spline_->sample(x, jets, inside);
    for (std::size_t k = 0; k < x.size(); ++k) {
      const double* jet = jets.col(static_cast<Eigen::Index>(k)).data();
      const Eigen::Map<const Vector<OutDim>> u(jet);
      const Eigen::Map<const Matrix<OutDim, InDim>> gradient(jet + OutDim);
      samples[k] = {affine_(x[k]) + u, affine_.linear + gradient, inside[k] != 0};
    }
  }

 private:
  AffineMap<InDim, OutDim> affine_;
  std::unique_ptr<SplineSampler<InDim>> spline_;
};

}  // namespace

/// u at a point of the domain: value, gradient (OutDim x InDim) and second derivatives.
template <int InDim, int OutDim>
struct SplineTransform<InDim, OutDim>::Jet {
  Vector<OutDim> value = Vector<OutDim>::Zero();
  Matrix<OutDim, InDim> gradient = Matrix<OutDim, InDim>::Zero();
  Matrix<OutDim, kNumSecondDerivatives<InDim>> hessian =
      Matrix<OutDim, kNumSecondDerivatives<InDim>>::Zero();
};

template <int InDim, int OutDim>
SplineTransform<InDim, OutDim>::SplineTransform(std::shared_ptr<const SplineBasis<InDim>> basis,
                                                const Affine& affine)
    : basis_(std::move(basis)), affine_(affine) {
  if (!basis_) throw InvalidInput("SplineTransform: the basis is null.");
  if (!affine_.finite()) throw InvalidInput("SplineTransform: the affine part is not finite.");
  edge_length_ = basis_->mean_edge_length();
  control_points_.setZero(OutDim, basis_->num_control_points());
  sum_ = basis_->sum(control_points_);
}

template <int InDim, int OutDim>
void SplineTransform<InDim, OutDim>::set_control_points(
    const Eigen::Ref<const ControlPoints<OutDim>>& control_points) {
  if (control_points.cols() != basis_->num_control_points()) {
    throw InvalidInput(message("SplineTransform: ", control_points.cols(),
                               " control points given, ", basis_->num_control_points(),
                               " expected."));
  }
  if (!control_points.allFinite()) {
    throw InvalidInput("SplineTransform: a control point is not finite.");
  }
  control_points_ = control_points;
  sum_ = basis_->sum(control_points_);
}

template <int InDim, int OutDim>
std::unique_ptr<Transform<InDim, OutDim>> SplineTransform<InDim, OutDim>::clone() const {
  return std::make_unique<SplineTransform>(*this);
}

template <int InDim, int OutDim>
typename SplineTransform<InDim, OutDim>::Jet SplineTransform<InDim, OutDim>::displacement(
    const Point<InDim>& p, int derivatives) const {
  Jet u;
  if (sum_ != nullptr) {
    const Eigen::MatrixXd sums = sum_->evaluate(p, derivatives);
    u.value = sums.col(0);
    if (derivatives > 0) u.gradient = sums.template middleCols<InDim>(1);
    if (derivatives > 1) u.hessian = sums.template rightCols<kNumSecondDerivatives<InDim>>();
    return u;
  }
  const auto here = basis_->evaluate(p, derivatives);
  for (std::size_t n = 0; n < here.control_points.size(); ++n) {
    const auto& phi = control_points_.col(here.control_points[n]);
    u.value += here.values[n] * phi;
    if (derivatives > 0) u.gradient += phi * here.gradients.col(n).transpose();
    if (derivatives > 1) u.hessian += phi * here.hessians.col(n).transpose();
  }
  return u;
}

template <int InDim, int OutDim>
Point<OutDim> SplineTransform<InDim, OutDim>::map(const Point<InDim>& x) const {
  if (basis_->contains(x)) return affine_(x) + displacement(x, 0).value;
  const Point<InDim> p = basis_->nearest_point(x);
  const Jet u = displacement(p, 1);
  return affine_(x) + u.value + u.gradient * Continuation<InDim>(x - p, edge_length_).step;
}

template <int InDim, int OutDim>
Matrix<OutDim, InDim> SplineTransform<InDim, OutDim>::spatial_jacobian(
    const Point<InDim>& x) const {
  return sample(x).jacobian;
}

template <int InDim, int OutDim>
typename Transform<InDim, OutDim>::Sample SplineTransform<InDim, OutDim>::sample(
    const Point<InDim>& x) const {
  if (basis_->contains(x)) {
    const Jet u = displacement(x, 1);
    return {affine_(x) + u.value, affine_.linear + u.gradient, true};
  }
  const Point<InDim> p = basis_->nearest_point(x);
  const Jet u = displacement(p, 1);
  const Continuation<InDim> on(x - p, edge_length_);
  return {affine_(x) + u.value + u.gradient * on.step, affine_.linear + u.gradient * on.stretch,
          false};
}

template <int InDim, int OutDim>
std::unique_ptr<TransformSampler<InDim, OutDim>> SplineTransform<InDim, OutDim>::sampler() const {
  auto spline = basis_->sampler(control_points_);
  if (spline == nullptr) return Transform<InDim, OutDim>::sampler();
  return std::make_unique<SplineTransformSampler<InDim, OutDim>>(affine_, std::move(spline));
}

template <int InDim, int OutDim>
std::array<Matrix<InDim>, OutDim> SplineTransform<InDim, OutDim>::second_derivatives(
    const Point<InDim>& x) const {
  const Jet u = displacement(basis_->nearest_point(x), 2);
  std::array<Matrix<InDim>, OutDim> result;
  for (int c = 0; c < OutDim; ++c) {
    for (int a = 0, s = 0; a < InDim; ++a) {
      for (int b = a; b < InDim; ++b, ++s) result[c](a, b) = result[c](b, a) = u.hessian(c, s);
    }
  }
  return result;
}

template <int InDim, int OutDim>
Eigen::VectorXd SplineTransform<InDim, OutDim>::parameters() const {
  return control_points_.reshaped();
}

template <int InDim, int OutDim>
void SplineTransform<InDim, OutDim>::set_parameters(
    const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  check_parameters("SplineTransform", parameters, num_parameters());
  control_points_.reshaped() = parameters;
  sum_ = basis_->sum(control_points_);
}

template <int InDim, int OutDim>
void SplineTransform<InDim, OutDim>::add_adjoint(std::span<const Point<InDim>> x,
                                                 std::span<const Vector<OutDim>> forces,
                                                 Eigen::Ref<Eigen::VectorXd> gradient) const {
  check_adjoint("SplineTransform", x.size(), forces.size(), gradient.size(), num_parameters());
  Eigen::Map<ControlPoints<OutDim>> columns(gradient.data(), OutDim, control_points_.cols());
  for (std::size_t k = 0; k < x.size(); ++k) {
    const auto here = continued(*basis_, edge_length_, x[k]);
    for (std::size_t n = 0; n < here.control_points.size(); ++n) {
      columns.col(here.control_points[n]) += here.values[n] * forces[k];
    }
  }
}

template class SplineTransform<2, 2>;
template class SplineTransform<3, 3>;
template class SplineTransform<2, 3>;

}  // namespace crease
