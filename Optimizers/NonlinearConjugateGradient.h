#pragma once

#include "Optimizers/Optimizer.h"

namespace crease {

/// Line search and first step.
struct NonlinearConjugateGradientOptions {
  bool precondition = true;  ///< by ObjectiveFunction::preconditioner(), where there is one
  double first_step = 1.0;   ///< step_length() of the first trial where there is none
};

/// Nonlinear conjugate gradients by Polak and Ribiere, preconditioned by the same substitution as Lbfgs: no
/// memory but the last direction, so line searches must be nearer to exact (a tenth of the slope may be left), and
/// an iteration takes two passes where L-BFGS takes one.
///
/// Source: E. Polak, G. Ribiere, "Note sur la convergence de methodes de directions conjuguees", 1969; S. Agarwal,
/// K. Mierle, "Ceres Solver".
class NonlinearConjugateGradient final : public Optimizer {
 public:
  /// @throws InvalidInput for options out of range.
  explicit NonlinearConjugateGradient(const OptimizerOptions& stopping = {.max_iterations = 1000},
                                      const NonlinearConjugateGradientOptions& options = {});

  OptimizerResult minimize(ObjectiveFunction& function, const Eigen::VectorXd& start,
                           const NullSpace* null_space = nullptr,
                           const ProgressCallback& progress = {}) const override;

 private:
  OptimizerOptions stopping_;
  NonlinearConjugateGradientOptions options_;
};

}  // namespace crease
