#pragma once

#include "Optimizers/Optimizer.h"

namespace crease {

/// How long steps are tried.
struct SteepestDescentOptions {
  double first_step = 1.0;  ///< step_length() of the very first trial
  double sufficient_decrease =
      1e-4;  ///< Armijo: share of the slope's decrease that a step must reach
  double shortening = 0.5;
  int max_shortenings = 40;  ///< none of them lowers the value: stop
};

/// Steepest descent with backtracking: the baseline that others are compared with.
///
/// dY = -t (N^T N)^-1 N^T g, the steepest direction in Phi, so that every null space takes the same path. t
/// starts at Barzilai and Borwein's |dPhi|^2 / (dPhi . dg) and is halved until Armijo's rule holds; the
/// value falls in every iteration. One pass with gradient per trial.
///
/// Source: J. Barzilai, J. M. Borwein, "Two-Point Step Size Gradient Methods", IMA J. Num. An. 8, 1988;
/// L. Armijo, Pacific J. Math. 16, 1966.
class SteepestDescent final : public Optimizer {
 public:
  /// @throws InvalidInput for options out of range.
  explicit SteepestDescent(const OptimizerOptions& stopping = {.max_iterations = 5000},
                           const SteepestDescentOptions& options = {});

  OptimizerResult minimize(ObjectiveFunction& function, const Eigen::VectorXd& start,
                           const NullSpace* null_space = nullptr,
                           const ProgressCallback& progress = {}) const override;

 private:
  OptimizerOptions stopping_;
  SteepestDescentOptions options_;
};

}  // namespace crease
