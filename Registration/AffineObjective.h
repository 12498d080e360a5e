#pragma once

#include <memory>

#include "Metrics/Metric.h"
#include "Optimizers/ObjectiveFunction.h"
#include "Transforms/AffineMap.h"
#include "Transforms/Transform.h"

namespace crease {

/// A metric as a function of the few parameters of a transform that is an affine map of space (rigid,
/// similarity, affine).
///
/// With q_0 = T(c), q_k = T(c + e_k) and the coordinates b_k(x) of x in that frame, T(x) = sum b_k(x) q_k
/// and dE/dq_k = sum_x F(x) b_k(x), d^2E/dq_j dq_k = sum_x G(x) b_j b_k; the chain rule by dq/dp gives
/// the rest. So a sweep costs Dim + 1 moments per row, whatever the parameters are.
template <int Dim>
class AffineObjective final : public ObjectiveFunction {
 public:
  /// @param frame   the point c, mm: the centroid of what is compared.
  /// @param radius  length of the frame's axes, mm: about the size of the domain.
  AffineObjective(std::shared_ptr<Metric<Dim>> metric, std::unique_ptr<Transform<Dim>> transform,
                  const Point<Dim>& frame, double radius);

  Eigen::Index size() const override { return transform_->num_parameters(); }
  /// Infinite where so few samples fall inside the moving image that the metric refuses, unless it is the
  /// first point of all.
  double evaluate(const Eigen::Ref<const Eigen::VectorXd>& parameters, Eigen::VectorXd* gradient,
                  Eigen::SparseMatrix<double>* hessian) override;
  /// A bound on the movement of the frame's corners, in samples of the fixed image.
  double step_length(const Eigen::Ref<const Eigen::VectorXd>& step) const override;
  /// The map at the parameters.
  AffineMap<Dim> map(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;

 private:
  struct Moments;
  double sweep(const AffineMap<Dim>& affine, Moments* total);
  Eigen::MatrixXd frame_jacobian() const;

  std::shared_ptr<Metric<Dim>> metric_;
  std::unique_ptr<Transform<Dim>> transform_;
  std::array<Point<Dim>, Dim + 1> frame_;
  double radius_;
  bool evaluated_ = false;  // at least once
};

extern template class AffineObjective<2>;
extern template class AffineObjective<3>;

}  // namespace crease
