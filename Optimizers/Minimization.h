#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "Optimizers/Optimizer.h"

namespace crease {

/// A point of a minimisation with everything one pass yields there.
struct EvaluatedPoint {
  Eigen::VectorXd y, x;  // x = N y + x0
  double value = 0.0;
  Eigen::VectorXd gradient;             // N^T dE/dx
  Eigen::SparseMatrix<double> hessian;  // d2E/dx2, lower triangle, where asked for
};

/// What all optimizers share: evaluation in the null space, checks, counters, history, stopping rules.
class Minimization {
 public:
  /// Checks sizes, carries the start onto the constraints, and evaluates there.
  Minimization(ObjectiveFunction& function, const Eigen::VectorXd& start,
               const NullSpace* null_space, const OptimizerOptions& options,
               const ProgressCallback& progress, bool with_hessian);

  const NullSpace& null_space() const { return *null_space_; }
  const EvaluatedPoint& current() const { return current_; }
  const EvaluatedPoint& trial() const { return trial_; }
  /// Evaluates at y; no NaN passes. The trial is overwritten by the next one.
  const EvaluatedPoint& evaluate_trial(Eigen::VectorXd y);
  /// The value at y alone, which leaves the trial as it is; no NaN passes.
  double value_at(const Eigen::VectorXd& y);
  /// step_length() of current -> trial, in x.
  double trial_step() const;
  /// Makes the trial the current point, records it and applies the stopping rules.
  void accept_trial(double damping = 0.0);
  /// After trials along a step that did not lower the value: too small an expected decrease counts as a
  /// small one, and none that rounding would show stops.
  void reject_trial(double expected_decrease);
  /// Stops for a reason that only the optimizer sees; the first reason stays.
  void stop(StopReason reason);
  bool stopped() const { return reason_.has_value(); }
  /// Whether time is up; stops then. To be asked between trials.
  bool out_of_time();
  int iterations() const { return history_.back().iteration; }
  /// Factorisations and conjugate gradient steps so far, for the history.
  void set_linear_work(int factorizations, int linear_iterations);
  OptimizerResult result() const;

 private:
  void evaluate(EvaluatedPoint& at);
  void check_value(double value) const;
  std::string where() const;
  void record(IterationRecord record);
  bool count_decrease(double decrease);
  double seconds() const;

  ObjectiveFunction& function_;
  std::unique_ptr<const NullSpace> unconstrained_;
  const NullSpace* null_space_;
  const OptimizerOptions& options_;
  const ProgressCallback& progress_;
  bool with_hessian_;
  std::chrono::steady_clock::time_point start_time_ = std::chrono::steady_clock::now();
  EvaluatedPoint current_, trial_;
  Eigen::VectorXd full_gradient_;
  std::vector<IterationRecord> history_;
  std::optional<StopReason> reason_;
  int small_decreases_ = 0;
  struct Work {
    int evaluations = 0, factorizations = 0, linear_iterations = 0;
  };
  Work work_, recorded_work_;
};

}  // namespace crease
