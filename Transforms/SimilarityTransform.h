#pragma once

#include "Transforms/AffineMap.h"
#include "Transforms/Rotation.h"
#include "Transforms/Transform.h"

namespace crease {

/// T(x) = s R (x - c) + c + t about a fixed centre c, R a rotation, s > 0 one scale for all axes.
///
/// Parameters: the angles of R (RotationAngles, radians), log s (so that every value is a valid one, and
/// equal steps shrink and grow alike), then t (mm).
template <int Dim>
class SimilarityTransform final : public Transform<Dim> {
 public:
  static constexpr int kNumAngles = Dim == 2 ? 1 : 3;
  using Angles = RotationAngles<Dim>;

  /// The identity about a centre in mm.
  explicit SimilarityTransform(const Point<Dim>& centre = Point<Dim>::Zero());
  /// x -> M x + offset about the centre. @throws InvalidInput when M is not a rotation times a scale.
  explicit SimilarityTransform(const AffineMap<Dim>& map,
                               const Point<Dim>& centre = Point<Dim>::Zero());

  const Point<Dim>& centre() const { return centre_; }
  const Matrix<Dim>& rotation() const { return rotation_; }
  const Angles& angles() const { return angles_; }
  /// s, no unit.
  double scale() const { return scale_; }
  const Vector<Dim>& translation() const { return translation_; }
  AffineMap<Dim> affine_map() const;

  std::unique_ptr<Transform<Dim>> clone() const override;
  Point<Dim> map(const Point<Dim>& x) const override;
  Matrix<Dim> spatial_jacobian(const Point<Dim>&) const override { return scale_ * rotation_; }
  Eigen::Index num_parameters() const override { return kNumAngles + 1 + Dim; }
  Eigen::VectorXd parameters() const override;
  void set_parameters(const Eigen::Ref<const Eigen::VectorXd>& parameters) override;
  void add_adjoint(std::span<const Point<Dim>> x, std::span<const Vector<Dim>> forces,
                   Eigen::Ref<Eigen::VectorXd> gradient) const override;

 private:
  Point<Dim> centre_;
  Angles angles_ = Angles::Zero();
  double log_scale_ = 0, scale_ = 1;
  Vector<Dim> translation_ = Vector<Dim>::Zero();
  Matrix<Dim> rotation_ = Matrix<Dim>::Identity();
};

extern template class SimilarityTransform<2>;
extern template class SimilarityTransform<3>;

}  // namespace crease
