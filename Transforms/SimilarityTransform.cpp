#include "Transforms/SimilarityTransform.h"

#include <Eigen/LU>
#include <cmath>

#include "Core/Error.h"
#include "Transforms/ParameterCheck.h"

namespace crease {

template <int Dim>
SimilarityTransform<Dim>::SimilarityTransform(const Point<Dim>& centre) : centre_(centre) {
  if (!centre.allFinite()) throw InvalidInput("SimilarityTransform: the centre is not finite.");
}

template <int Dim>
SimilarityTransform<Dim>::SimilarityTransform(const AffineMap<Dim>& map, const Point<Dim>& centre)
    : SimilarityTransform(centre) {
  const double volume = map.finite() ? map.linear.determinant() : 0;
  const double scale = volume > 0 ? std::pow(volume, 1.0 / Dim) : 1;
  if (!(volume > 0) || !is_rotation<Dim>(map.linear / scale)) {
    throw InvalidInput(message("SimilarityTransform: the matrix\n", map.linear,
                               "\nis not a rotation times a scale."));
  }
  angles_ = rotation_angles<Dim>(map.linear / scale);
  rotation_ = rotation_matrix<Dim>(angles_);
  log_scale_ = std::log(scale);
  scale_ = std::exp(log_scale_);
  translation_ = map(centre) - centre;
}

template <int Dim>
AffineMap<Dim> SimilarityTransform<Dim>::affine_map() const {
  const Matrix<Dim> linear = scale_ * rotation_;
  return {linear, centre_ + translation_ - linear * centre_};
}

template <int Dim>
std::unique_ptr<Transform<Dim>> SimilarityTransform<Dim>::clone() const {
  return std::make_unique<SimilarityTransform>(*this);
}

template <int Dim>
Point<Dim> SimilarityTransform<Dim>::map(const Point<Dim>& x) const {
  return scale_ * (rotation_ * (x - centre_)) + centre_ + translation_;
}

template <int Dim>
Eigen::VectorXd SimilarityTransform<Dim>::parameters() const {
  Eigen::VectorXd p(num_parameters());
  p << angles_, log_scale_, translation_;
  return p;
}

template <int Dim>
void SimilarityTransform<Dim>::set_parameters(const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  check_parameters("SimilarityTransform", parameters, num_parameters());
  angles_ = parameters.template head<kNumAngles>();
  log_scale_ = parameters[kNumAngles];
  translation_ = parameters.template tail<Dim>();
  rotation_ = rotation_matrix<Dim>(angles_);
  scale_ = std::exp(log_scale_);
}

template <int Dim>
void SimilarityTransform<Dim>::add_adjoint(std::span<const Point<Dim>> x,
                                           std::span<const Vector<Dim>> forces,
                                           Eigen::Ref<Eigen::VectorXd> gradient) const {
  check_adjoint("SimilarityTransform", x.size(), forces.size(), gradient.size(), num_parameters());
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Vector<Dim> v = scale_ * (x[k] - centre_);
    gradient.template head<kNumAngles>() +=
        rotated_by_angles<Dim>(rotation_, angles_, v).transpose() * forces[k];
    gradient[kNumAngles] += (rotation_ * v).dot(forces[k]);
    gradient.template tail<Dim>() += forces[k];
  }
}

template class SimilarityTransform<2>;
template class SimilarityTransform<3>;

}  // namespace crease
