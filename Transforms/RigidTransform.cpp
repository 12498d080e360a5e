#include "Transforms/RigidTransform.h"

#include "Core/Error.h"
#include "Transforms/ParameterCheck.h"

namespace crease {

template <int Dim>
RigidTransform<Dim>::RigidTransform(const Point<Dim>& centre) : centre_(centre) {
  if (!centre.allFinite()) throw InvalidInput("RigidTransform: the centre is not finite.");
}

template <int Dim>
RigidTransform<Dim>::RigidTransform(const AffineMap<Dim>& map, const Point<Dim>& centre)
    : RigidTransform(centre) {
  if (!map.finite() || !is_rotation<Dim>(map.linear)) {
    throw InvalidInput(message("RigidTransform: the matrix\n", map.linear, "\nis not a rotation."));
  }
  angles_ = rotation_angles<Dim>(map.linear);
  rotation_ = rotation_matrix<Dim>(angles_);
  translation_ = map(centre) - centre;
}

template <int Dim>
AffineMap<Dim> RigidTransform<Dim>::affine_map() const {
  return {rotation_, centre_ + translation_ - rotation_ * centre_};
}

template <int Dim>
std::unique_ptr<Transform<Dim>> RigidTransform<Dim>::clone() const {
  return std::make_unique<RigidTransform>(*this);
}

template <int Dim>
Point<Dim> RigidTransform<Dim>::map(const Point<Dim>& x) const {
  return rotation_ * (x - centre_) + centre_ + translation_;
}

template <int Dim>
Eigen::VectorXd RigidTransform<Dim>::parameters() const {
  Eigen::VectorXd p(num_parameters());
  p << angles_, translation_;
  return p;
}

template <int Dim>
void RigidTransform<Dim>::set_parameters(const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  check_parameters("RigidTransform", parameters, num_parameters());
  angles_ = parameters.template head<kNumAngles>();
  translation_ = parameters.template tail<Dim>();
  rotation_ = rotation_matrix<Dim>(angles_);
}

template <int Dim>
void RigidTransform<Dim>::add_adjoint(std::span<const Point<Dim>> x,
                                      std::span<const Vector<Dim>> forces,
                                      Eigen::Ref<Eigen::VectorXd> gradient) const {
  check_adjoint("RigidTransform", x.size(), forces.size(), gradient.size(), num_parameters());
  for (std::size_t k = 0; k < x.size(); ++k) {
    gradient.template head<kNumAngles>() +=
        rotated_by_angles<Dim>(rotation_, angles_, x[k] - centre_).transpose() * forces[k];
    gradient.template tail<Dim>() += forces[k];
  }
}

template class RigidTransform<2>;
template class RigidTransform<3>;

}  // namespace crease
