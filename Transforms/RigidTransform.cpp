#include "Transforms/RigidTransform.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "Core/Error.h"
#include "Transforms/ParameterCheck.h"

namespace crease {
namespace {

Matrix<3> cross_matrix(const Vector<3>& w) {
  return Matrix<3>{{0, -w[2], w[1]}, {w[2], 0, -w[0]}, {-w[1], w[0], 0}};
}

Matrix<2> rotation(const Eigen::Matrix<double, 1, 1>& angle) {
  return Eigen::Rotation2Dd(angle[0]).toRotationMatrix();
}

Matrix<3> rotation(const Vector<3>& w) {
  const double angle = w.norm();
  if (angle == 0) return Matrix<3>::Identity();
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

Eigen::Matrix<double, 1, 1> angles_of(const Matrix<2>& r) {
  return Eigen::Matrix<double, 1, 1>(std::atan2(r(1, 0), r(0, 0)));
}

Vector<3> angles_of(const Matrix<3>& r) {
  const Eigen::AngleAxisd turn(r);
  return turn.angle() * turn.axis();
}

/// d(R v)/dangle.
Matrix<2, 1> by_angles(const Matrix<2>& r, const Eigen::Matrix<double, 1, 1>&, const Vector<2>& v) {
  const Vector<2> turned = r * v;
  return {-turned[1], turned[0]};
}

/// d(R(w) v)/dw = -R [v] J, J = I - (1 - cos a)/a^2 [w] + (a - sin a)/a^3 [w]^2, a = |w|.
Matrix<3> by_angles(const Matrix<3>& r, const Vector<3>& w, const Vector<3>& v) {
  const double a = w.norm(), a2 = a * a;
  const bool small = a < 1e-4;  // the next terms of the series are below rounding
  const double first = small ? 0.5 - a2 / 24 : (1 - std::cos(a)) / a2;
  const double second = small ? 1.0 / 6 - a2 / 120 : (a - std::sin(a)) / (a2 * a);
  const Matrix<3> cross = cross_matrix(w);
  const Matrix<3> j = Matrix<3>::Identity() - first * cross + second * cross * cross;
  return -r * cross_matrix(v) * j;
}

}  // namespace

template <int Dim>
RigidTransform<Dim>::RigidTransform(const Point<Dim>& centre) : centre_(centre) {
  if (!centre.allFinite()) throw InvalidInput("RigidTransform: the centre is not finite.");
}

template <int Dim>
RigidTransform<Dim>::RigidTransform(const AffineMap<Dim>& map, const Point<Dim>& centre)
    : RigidTransform(centre) {
  if (!map.finite() || !map.linear.isUnitary(1e-9) || map.linear.determinant() < 0) {
    throw InvalidInput(message("RigidTransform: the matrix\n", map.linear, "\nis not a rotation."));
  }
  angles_ = angles_of(map.linear);
  rotation_ = crease::rotation(angles_);
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
  rotation_ = crease::rotation(angles_);
}

template <int Dim>
void RigidTransform<Dim>::add_adjoint(std::span<const Point<Dim>> x,
                                      std::span<const Vector<Dim>> forces,
                                      Eigen::Ref<Eigen::VectorXd> gradient) const {
  check_adjoint("RigidTransform", x.size(), forces.size(), gradient.size(), num_parameters());
  for (std::size_t k = 0; k < x.size(); ++k) {
    gradient.template head<kNumAngles>() +=
        by_angles(rotation_, angles_, x[k] - centre_).transpose() * forces[k];
    gradient.template tail<Dim>() += forces[k];
  }
}

template class RigidTransform<2>;
template class RigidTransform<3>;

}  // namespace crease
