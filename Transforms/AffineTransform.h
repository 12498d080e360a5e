#pragma once

#include "Transforms/AffineMap.h"
#include "Transforms/Transform.h"

namespace crease {

/// T(x) = L (x - c) + c + t about a fixed centre c.
///
/// Parameters: the Dim x Dim entries of L row by row (no unit), then t (mm); those of ITK's
/// AffineTransform.
template <int Dim>
class AffineTransform final : public Transform<Dim> {
 public:
  /// The identity about a centre in mm.
  explicit AffineTransform(const Point<Dim>& centre = Point<Dim>::Zero());
  /// The map given, expressed about the centre. @throws InvalidInput when a number is not finite.
  explicit AffineTransform(const AffineMap<Dim>& map,
                           const Point<Dim>& centre = Point<Dim>::Zero());

  const Point<Dim>& centre() const { return centre_; }
  AffineMap<Dim> affine_map() const;

  std::unique_ptr<Transform<Dim>> clone() const override;
  Point<Dim> map(const Point<Dim>& x) const override;
  Matrix<Dim> spatial_jacobian(const Point<Dim>&) const override { return linear_; }
  Eigen::Index num_parameters() const override { return Dim * Dim + Dim; }
  Eigen::VectorXd parameters() const override;
  void set_parameters(const Eigen::Ref<const Eigen::VectorXd>& parameters) override;
  void add_adjoint(std::span<const Point<Dim>> x, std::span<const Vector<Dim>> forces,
                   Eigen::Ref<Eigen::VectorXd> gradient) const override;
  bool linear_in_parameters() const override { return true; }

 private:
  Point<Dim> centre_;
  Matrix<Dim> linear_ = Matrix<Dim>::Identity();
  Vector<Dim> translation_ = Vector<Dim>::Zero();
};

extern template class AffineTransform<2>;
extern template class AffineTransform<3>;

}  // namespace crease
