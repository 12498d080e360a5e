#pragma once

#include <vector>

#include "Transforms/Transform.h"

namespace crease {

/// One transform after the other: T(x) = T_n( ... T_2(T_1(x))), the first of the list first.
/// Parameters are those of the parts, in the same order.
template <int Dim>
class CompositeTransform final : public Transform<Dim> {
 public:
  /// @throws InvalidInput when a part is null. No parts: the identity.
  explicit CompositeTransform(std::vector<std::unique_ptr<Transform<Dim>>> parts);
  CompositeTransform(const CompositeTransform& other);
  CompositeTransform& operator=(const CompositeTransform&) = delete;

  std::size_t num_parts() const { return parts_.size(); }
  const Transform<Dim>& part(std::size_t k) const { return *parts_.at(k); }

  std::unique_ptr<Transform<Dim>> clone() const override;
  Point<Dim> map(const Point<Dim>& x) const override;
  Matrix<Dim> spatial_jacobian(const Point<Dim>& x) const override;
  typename Transform<Dim>::Sample sample(const Point<Dim>& x) const override;
  std::unique_ptr<TransformSampler<Dim, Dim>> sampler() const override;
  /// Whether every part is within its own domain on the way.
  bool in_domain(const Point<Dim>& x) const override;
  Eigen::Index num_parameters() const override;
  Eigen::VectorXd parameters() const override;
  void set_parameters(const Eigen::Ref<const Eigen::VectorXd>& parameters) override;
  void add_adjoint(std::span<const Point<Dim>> x, std::span<const Vector<Dim>> forces,
                   Eigen::Ref<Eigen::VectorXd> gradient) const override;

 private:
  std::vector<std::unique_ptr<Transform<Dim>>> parts_;
};

extern template class CompositeTransform<2>;
extern template class CompositeTransform<3>;

}  // namespace crease
