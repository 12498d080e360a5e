#pragma once

#include <memory>

#include "Optimizers/DampedSolver.h"
#include "Optimizers/Optimizer.h"

namespace crease {

class Minimization;

/// Damping, shortening and the linear systems.
struct GaussNewtonOptions {
  LinearSolverOptions linear_solver = {};
  double initial_damping = 1e-3;  ///< mu, relative to the diagonal
  int max_shortenings = 2;  ///< of a step that did not lower the value, before mu grows fourfold
  double shortening = 0.35;
  /// Keeps analyses and factors from one minimisation to the next of the same kind, one at a time; null: each
  /// starts afresh.
  std::shared_ptr<DampedSolver> solver = nullptr;
};

/// Gauss-Newton with Levenberg-Marquardt damping:  (N^T H N + mu diag) dY = -N^T g.
///
/// Every trial point is evaluated once, with gradient and Hessian: if it is accepted, that pass is the next
/// step's. A rejected step is first shortened, which needs no new factor, and only then damped more. mu
/// falls to a quarter after a full step and grows fourfold after one that was shortened or given up.
///
/// Source: D. W. Marquardt, "An Algorithm for Least-Squares Estimation of Nonlinear Parameters", 1963.
class GaussNewton final : public Optimizer {
 public:
  /// @throws InvalidInput for options out of range.
  explicit GaussNewton(const OptimizerOptions& stopping = {},
                       const GaussNewtonOptions& options = {});

  OptimizerResult minimize(ObjectiveFunction& function, const Eigen::VectorXd& start,
                           const NullSpace* null_space = nullptr,
                           const ProgressCallback& progress = {}) const override;

 private:
  double find_decrease(Minimization& run, const Eigen::VectorXd& step) const;

  OptimizerOptions stopping_;
  GaussNewtonOptions options_;
};

}  // namespace crease
