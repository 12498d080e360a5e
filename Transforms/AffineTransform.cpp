#include "Transforms/AffineTransform.h"

#include "Core/Error.h"
#include "Transforms/ParameterCheck.h"

namespace crease {

template <int Dim>
AffineTransform<Dim>::AffineTransform(const Point<Dim>& centre) : centre_(centre) {
  if (!centre.allFinite()) throw InvalidInput("AffineTransform: the centre is not finite.");
}

template <int Dim>
AffineTransform<Dim>::AffineTransform(const AffineMap<Dim>& map, const Point<Dim>& centre)
    : AffineTransform(centre) {
  if (!map.finite()) throw InvalidInput("AffineTransform: the map is not finite.");
  linear_ = map.linear;
  translation_ = map(centre) - centre;
}

template <int Dim>
AffineMap<Dim> AffineTransform<Dim>::affine_map() const {
  return {linear_, centre_ + translation_ - linear_ * centre_};
}

template <int Dim>
std::unique_ptr<Transform<Dim>> AffineTransform<Dim>::clone() const {
  return std::make_unique<AffineTransform>(*this);
}

template <int Dim>
Point<Dim> AffineTransform<Dim>::map(const Point<Dim>& x) const {
  return linear_ * (x - centre_) + centre_ + translation_;
}

template <int Dim>
Eigen::VectorXd AffineTransform<Dim>::parameters() const {
  Eigen::VectorXd p(num_parameters());
  p << linear_.transpose().reshaped(), translation_;
  return p;
}

template <int Dim>
void AffineTransform<Dim>::set_parameters(const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  check_parameters("AffineTransform", parameters, num_parameters());
  linear_ = parameters.template head<Dim * Dim>().reshaped(Dim, Dim).transpose();
  translation_ = parameters.template tail<Dim>();
}

template <int Dim>
void AffineTransform<Dim>::add_adjoint(std::span<const Point<Dim>> x,
                                       std::span<const Vector<Dim>> forces,
                                       Eigen::Ref<Eigen::VectorXd> gradient) const {
  check_adjoint("AffineTransform", x.size(), forces.size(), gradient.size(), num_parameters());
  for (std::size_t k = 0; k < x.size(); ++k) {
    for (int row = 0; row < Dim; ++row) {
      gradient.template segment<Dim>(Dim * row) += forces[k][row] * (x[k] - centre_);
    }
    gradient.template tail<Dim>() += forces[k];
  }
}

template class AffineTransform<2>;
template class AffineTransform<3>;

}  // namespace crease
