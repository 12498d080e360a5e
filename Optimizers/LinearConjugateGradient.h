#pragma once

#include <Eigen/Core>
#include <functional>

namespace crease {

/// When to stop.
struct LinearConjugateGradientOptions {
  double tolerance = 0.1;  ///< stop at this value of sqrt(r^T z) relative to its first value
  int max_iterations = 12;
};

/// The last iterate, and why it is the last.
struct LinearConjugateGradientResult {
  Eigen::VectorXd x;
  int iterations = 0;
  bool converged = false;
  bool breakdown = false;  ///< A or the preconditioner is not positive definite, or not finite
};

/// Solves A x = b for symmetric positive definite A by preconditioned conjugate gradients from x = 0; z =
/// M^-1 r is the preconditioned residual. Every iterate is a descent direction of 1/2 x^T A x - b^T x.
///
/// Source: Hestenes and Stiefel 1952; Y. Saad, "Iterative Methods for Sparse Linear Systems", 9.2.
LinearConjugateGradientResult linear_conjugate_gradient(
    const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& apply,
    const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& precondition,
    const Eigen::Ref<const Eigen::VectorXd>& b, const LinearConjugateGradientOptions& options = {});

}  // namespace crease
