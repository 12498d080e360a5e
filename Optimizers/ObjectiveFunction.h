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
  /// A positive semi-definite stand-in for the Hessian around x, constant during a minimisation, that says
  /// in which directions the function is stiff; gradient methods measure steps by it. Lower triangle,
  /// compressed, either size() x size() or scalar, m x m, the same for each of size() / m coordinates of
  /// x[size() / m * i + a]. Returns false when there is none.
  virtual bool preconditioner(const Eigen::Ref<const Eigen::VectorXd>& /*x*/,
                              Eigen::SparseMatrix<double>& /*matrix*/) {
    return false;
  }
  /// Length of a step in the unit that the stopping rule speaks of (for registration: the largest
  /// displacement in pixels on the sample grid); the largest entry unless overridden.
  virtual double step_length(const Eigen::Ref<const Eigen::VectorXd>& step) const {
    return step.size() == 0 ? 0.0 : step.cwiseAbs().maxCoeff();
  }
};

}  // namespace crease
