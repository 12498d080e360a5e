#pragma once

#include "Optimizers/Optimizer.h"

namespace crease {

/// How far the iteration goes.
struct DampedIterationOptions {
  double step = 0.01;     ///< h
  int max_halvings = 10;  ///< of h in all, each after a step that raised the value
};

/// The damped fixed-point iteration for a quadratic form plus a force, E(x) = 1/2 x^T M x + G(x):
///
///     M w = -grad G(x),   x <- h w + (1 - h) x,     that is   x <- x - h M^-1 grad E(x),
///
/// steepest descent in the norm of M with steps of one length. It converges for h < 2 / (1 + rho), rho the
/// largest eigenvalue of M^-1 times G's Hessian, in the order of 1/h iterations: kept to compare with. Guarded:
/// where the value grows, h is halved. The history's `damping` is h.
///
/// Source: dissertation, (4.13), (4.14).
class DampedIteration final : public Optimizer {
 public:
  /// @param M  of the function's size, symmetric, its lower triangle, compressed; positive definite in the
  ///           null space that minimize() is given.
  /// @throws InvalidInput for options out of range.
  explicit DampedIteration(const Eigen::SparseMatrix<double>& M,
                           const OptimizerOptions& stopping = {},
                           const DampedIterationOptions& options = {});

  /// @throws SolverError also when M is not positive definite in the null space, or the value still grows
  /// after the last halving.
  OptimizerResult minimize(ObjectiveFunction& function, const Eigen::VectorXd& start,
                           const NullSpace* null_space = nullptr,
                           const ProgressCallback& progress = {}) const override;

 private:
  Eigen::SparseMatrix<double> M_;
  OptimizerOptions stopping_;
  DampedIterationOptions options_;
};

}  // namespace crease
