#include "Transforms/Rotation.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace crease {
namespace {

Matrix<3> cross_matrix(const Vector<3>& w) {
  return Matrix<3>{{0, -w[2], w[1]}, {w[2], 0, -w[0]}, {-w[1], w[0], 0}};
}

}  // namespace

template <>
Matrix<2> rotation_matrix<2>(const RotationAngles<2>& angle) {
  return Eigen::Rotation2Dd(angle[0]).toRotationMatrix();
}

template <>
Matrix<3> rotation_matrix<3>(const RotationAngles<3>& w) {
  const double angle = w.norm();
  if (angle == 0) return Matrix<3>::Identity();
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

template <>
RotationAngles<2> rotation_angles<2>(const Matrix<2>& r) {
  return RotationAngles<2>(std::atan2(r(1, 0), r(0, 0)));
}

template <>
RotationAngles<3> rotation_angles<3>(const Matrix<3>& r) {
  const Eigen::AngleAxisd turn(r);
  return turn.angle() * turn.axis();
}

template <>
Matrix<2, 1> rotated_by_angles<2>(const Matrix<2>& r, const RotationAngles<2>&,
                                  const Vector<2>& v) {
  const Vector<2> turned = r * v;
  return {-turned[1], turned[0]};
}

/// d(R(w) v)/dw = -R [v] J, J = I - (1 - cos a)/a^2 [w] + (a - sin a)/a^3 [w]^2, a = |w|.
template <>
Matrix<3> rotated_by_angles<3>(const Matrix<3>& r, const RotationAngles<3>& w, const Vector<3>& v) {
  const double a = w.norm(), a2 = a * a;
  const bool small = a < 1e-4;  // the next terms of the series are below rounding
  const double first = small ? 0.5 - a2 / 24 : (1 - std::cos(a)) / a2;
  const double second = small ? 1.0 / 6 - a2 / 120 : (a - std::sin(a)) / (a2 * a);
  const Matrix<3> cross = cross_matrix(w);
  const Matrix<3> j = Matrix<3>::Identity() - first * cross + second * cross * cross;
  return -r * cross_matrix(v) * j;
}

template <int Dim>
Matrix<Dim> nearest_rotation(const Matrix<Dim>& matrix) {
  const Eigen::JacobiSVD<Matrix<Dim>> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix<Dim> u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(Dim - 1) *= -1;
  return u * svd.matrixV().transpose();
}

template <int Dim>
bool is_rotation(const Matrix<Dim>& matrix) {
  return matrix.isUnitary(1e-9) && matrix.determinant() > 0;
}

template Matrix<2> nearest_rotation<2>(const Matrix<2>&);
template Matrix<3> nearest_rotation<3>(const Matrix<3>&);
template bool is_rotation<2>(const Matrix<2>&);
template bool is_rotation<3>(const Matrix<3>&);

}  // namespace crease
