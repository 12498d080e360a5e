#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "Optimizers/ObjectiveFunction.h"
#include "Registration/ImageTerm.h"
#include "Registration/LandmarkConstraints.h"
#include "Transforms/CurvaturePoints.h"
#include "Transforms/TransformLattice.h"

namespace crease {

/// The cost of any transform as a function of its parameters p, at one level of a registration:
///
///     E(p) = alpha E_I(T_p) + rho / 2 p^T R p + lambda / 2 sum_j |T_p(p_j) - q_j|^2 / s_j^2
///
/// with R the transform's roughness_matrix() and soft landmarks p_j, q_j.
///
/// The image term goes through a lattice (TransformLattice): one sweep over the samples with the lattice's
/// spline, and one value or force per node for the transform. Gauss-Newton's matrix is
/// sum_q J_q^T G_q J_q with the samples' curvature G gathered in blocks about half as large as what the
/// transform varies over (CurvaturePoints) and J the parameter_jacobian() at their middles, kept where
/// T is linear in p. All matrices are dense: every parameter may move every point.
template <int Dim>
class TransformObjective final : public ObjectiveFunction {
 public:
  /// What counts how much.
  struct Weights {
    double image = 1;      ///< alpha, 0 or more
    double roughness = 0;  ///< rho, 0 or more; above 0 the transform must know its roughness
    double landmarks = 1;  ///< lambda
  };

  /// @param lattice  null, with the metric, without images.
  /// @param affine   about what T is; the lattice holds the rest.
  /// @param detail   mm: the distance over which T varies.
  /// @throws InvalidInput when a roughness is wanted that the transform does not know, or the metric's
  /// samples are not the lattice's.
  TransformObjective(std::unique_ptr<Transform<Dim>> transform,
                     std::shared_ptr<const TransformLattice<Dim>> lattice,
                     std::shared_ptr<Metric<Dim>> metric, const AffineMap<Dim>& affine,
                     double detail, const Weights& weights, SoftLandmarks<Dim> landmarks = {});

  Eigen::Index size() const override { return transform_->num_parameters(); }
  /// @throws SolverError when a term is not finite; the message names the term.
  double evaluate(const Eigen::Ref<const Eigen::VectorXd>& parameters, Eigen::VectorXd* gradient,
                  Eigen::SparseMatrix<double>* hessian) override;
  /// The largest movement at the curvature's points, in pixels; the largest entry without images.
  double step_length(const Eigen::Ref<const Eigen::VectorXd>& step) const override;

  const Weights& weights() const { return weights_; }
  /// @throws InvalidInput as the constructor.
  void set_weights(const Weights& weights);
  /// Unweighted terms of the last evaluation: "image" the metric, "roughness" 1/2 p^T R p, "landmarks".
  const std::map<std::string, double>& terms() const { return terms_; }
  /// Null without images.
  const Metric<Dim>* metric() const { return image_ ? &image_->metric() : nullptr; }
  std::shared_ptr<Metric<Dim>> shared_metric() const {
    return image_ ? image_->shared_metric() : nullptr;
  }

 private:
  double add_image(Eigen::VectorXd* gradient, Eigen::MatrixXd* hessian);
  double add_roughness(const Eigen::VectorXd& parameters, Eigen::VectorXd* gradient,
                       Eigen::MatrixXd* hessian) const;
  double add_landmarks(Eigen::VectorXd* gradient, Eigen::MatrixXd* hessian) const;
  void renew_jacobian();

  std::unique_ptr<Transform<Dim>> transform_;
  std::shared_ptr<const TransformLattice<Dim>> lattice_;
  AffineMap<Dim> affine_;
  Weights weights_;
  SoftLandmarks<Dim> landmarks_;
  std::optional<ImageTerm<Dim>> image_;
  std::optional<CurvaturePoints<Dim>> curvature_points_;
  std::vector<Point<Dim>> points_;  // of the curvature
  Eigen::MatrixXd jacobian_;        // at the points; empty: not known
  std::optional<Eigen::MatrixXd> roughness_;
  std::map<std::string, double> terms_;
};

extern template class TransformObjective<2>;
extern template class TransformObjective<3>;

}  // namespace crease
