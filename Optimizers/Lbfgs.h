#pragma once

#include "Optimizers/Optimizer.h"

namespace crease {

/// Memory and line search.
struct LbfgsOptions {
  int memory = 10;  ///< pairs of steps and changes of the gradient that stand for curvature
  bool precondition = true;  ///< by ObjectiveFunction::preconditioner(), where there is one
  double first_step = 1.0;   ///< step_length() of the first trial where there is none
};

/// Limited-memory BFGS with a line search by the strong Wolfe conditions, preconditioned: gradients only, no
/// Hessian, so that it suits functions whose Gauss-Newton matrix is poor or costly.
///
/// In the variables Z of Y = Y0 + R^-1 Z, R^T R = N^T P N (Substitution), with P what the objective offers:
/// for a registration gamma K + beta K_R + alpha M: bending, rigidity, and a mass matrix weighted by |grad I_m|^2.
/// Ceres takes no first guess of the Hessian; the substitution gives the same. An iteration
/// costs one pass with gradient per trial (mostly one) and two triangular solves.
///
/// Source: J. Nocedal, "Updating Quasi-Newton Matrices with Limited Storage", Math. Comp. 35, 1980; S. Agarwal,
/// K. Mierle, "Ceres Solver".
class Lbfgs final : public Optimizer {
 public:
  /// @throws InvalidInput for options out of range.
  explicit Lbfgs(const OptimizerOptions& stopping = {.max_iterations = 1000},
                 const LbfgsOptions& options = {});

  OptimizerResult minimize(ObjectiveFunction& function, const Eigen::VectorXd& start,
                           const NullSpace* null_space = nullptr,
                           const ProgressCallback& progress = {}) const override;

 private:
  OptimizerOptions stopping_;
  LbfgsOptions options_;
};

}  // namespace crease
