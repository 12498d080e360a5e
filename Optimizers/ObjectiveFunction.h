#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace crease {

/// A differentiable function of a vector.
class ObjectiveFunction {
 public:
  virtual ~ObjectiveFunction() = default;
  virtual Eigen::Index size() const = 0;
  /// The value at x; fills the gradient (size()) and the Hessian (lower triangle, the same pattern at
  /// every call; exact or Gauss-Newton's, positive semi-definite) where these are not null.
  virtual double evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient,
                          Eigen::SparseMatrix<double>* hessian) = 0;
  /// Whether evaluate() can fill a Hessian.
  virtual bool has_hessian() const { return true; }
  /// Length of a step in the unit that the stopping rule speaks of (for registration: the largest
  /// displacement in pixels on the sample grid); the largest entry unless overridden.
  virtual double step_length(const Eigen::Ref<const Eigen::VectorXd>& step) const {
    return step.size() == 0 ? 0.0 : step.cwiseAbs().maxCoeff();
  }
};

}  // namespace crease
