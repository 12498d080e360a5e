#pragma once

#include "Transforms/AffineMap.h"
#include "Transforms/Rotation.h"
#include "Transforms/Transform.h"

namespace crease {

/// T(x) = R (x - c) + c + t about a fixed centre c, R a rotation.
///
/// Parameters: 2D the angle (radians, from the first axis to the second), 3D the rotation vector (its
/// length the angle in radians, its direction the axis); then t (mm).
template <int Dim>
class RigidTransform final : public Transform<Dim> {
 public:
  static constexpr int kNumAngles = Dim == 2 ? 1 : 3;
  using Angles = RotationAngles<Dim>;

  /// The identity about a centre in mm.
  explicit RigidTransform(const Point<Dim>& centre = Point<Dim>::Zero());
  /// x -> R x + offset about the centre. @throws InvalidInput when R is not a rotation.
  explicit RigidTransform(const AffineMap<Dim>& map, const Point<Dim>& centre = Point<Dim>::Zero());

  const Point<Dim>& centre() const { return centre_; }
  const Matrix<Dim>& rotation() const { return rotation_; }
  const Angles& angles() const { return angles_; }
  const Vector<Dim>& translation() const { return translation_; }
  AffineMap<Dim> affine_map() const;

  std::unique_ptr<Transform<Dim>> clone() const override;
  Point<Dim> map(const Point<Dim>& x) const override;
  Matrix<Dim> spatial_jacobian(const Point<Dim>&) const override { return rotation_; }
  Eigen::Index num_parameters() const override { return kNumAngles + Dim; }
  Eigen::VectorXd parameters() const override;
  void set_parameters(const Eigen::Ref<const Eigen::VectorXd>& parameters) override;
  void add_adjoint(std::span<const Point<Dim>> x, std::span<const Vector<Dim>> forces,
                   Eigen::Ref<Eigen::VectorXd> gradient) const override;

 private:
  Point<Dim> centre_;
  Angles angles_ = Angles::Zero();
  Vector<Dim> translation_ = Vector<Dim>::Zero();
  Matrix<Dim> rotation_ = Matrix<Dim>::Identity();
};

extern template class RigidTransform<2>;
extern template class RigidTransform<3>;

}  // namespace crease
