#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "Optimizers/NullSpace.h"
#include "Optimizers/ObjectiveFunction.h"

namespace crease {

/// When to stop; the first rule that holds. A rule at 0 is off where the comment says so.
struct OptimizerOptions {
  double relative_decrease = 1e-5;  ///< of the value per iteration; 0 = off ...
  int small_decreases = 3;          ///< ... that many iterations in a row
  double relative_gradient = 1e-6;  ///< of |N^T g|, relative to its first value; 0 = off
  double step_length = 0.0;         ///< in the unit of ObjectiveFunction::step_length(); 0 = off
  int max_iterations = 200;
  double max_seconds = std::numeric_limits<double>::infinity();
};

/// @throws InvalidInput when a rule is negative or not a number.
void check_options(const OptimizerOptions& options);

enum class StopReason {
  kSmallDecrease,  ///< the value hardly fell any more
  kSmallGradient,  ///< |N^T g| fell to its share of the first value
  kSmallStep,      ///< the step was shorter than asked for
  kNoDecrease,     ///< no step along the direction lowers the value: a minimum, to rounding
  kIterationLimit,
  kTimeLimit,
  kCancelled,  ///< by the callback
};

/// "the relative decrease of the value fell below its limit", ...
std::string to_string(StopReason reason);

/// One iteration: one step that was accepted (iteration 0 is the start).
struct IterationRecord {
  int iteration = 0;
  double value = 0.0;
  double gradient_norm = 0.0;  ///< |N^T g| at this point
  double step = 0.0;           ///< step_length() of the step that led here
  double damping = 0.0;        ///< relative Levenberg-Marquardt damping of that step
  int evaluations = 0;         ///< passes made for it, rejected ones included
  int factorizations = 0;
  int linear_iterations = 0;  ///< conjugate gradient steps
  double seconds = 0.0;       ///< since the start
};

/// The last point, and how it was reached.
struct OptimizerResult {
  Eigen::VectorXd x;  ///< satisfies the constraints, whatever the reason for stopping
  double value = 0.0;
  double initial_value = 0.0;
  int iterations = 0;
  StopReason reason = StopReason::kIterationLimit;
  std::string reason_text;
  int num_evaluations = 0;
  int num_factorizations = 0;
  std::vector<IterationRecord> history;

  bool improved() const { return value < initial_value; }
};

/// Called at the start and after every iteration; false cancels.
using ProgressCallback = std::function<bool(const IterationRecord&)>;

/// Minimises a differentiable function E(x) over all x = N y + x0 of a null space.
class Optimizer {
 public:
  virtual ~Optimizer() = default;
  /// @param start       is first carried onto the constraints: expand(coordinates(start))
  /// @param null_space  nullptr: no constraints
  /// @throws InvalidInput when the sizes differ or the function lacks a derivative that is needed;
  /// SolverError when value, gradient or Hessian is not a number (the message names the iteration).
  /// A trial point of infinite value is rejected. Not improving is a result, not an error.
  virtual OptimizerResult minimize(ObjectiveFunction& function, const Eigen::VectorXd& start,
                                   const NullSpace* null_space = nullptr,
                                   const ProgressCallback& progress = {}) const = 0;
};

}  // namespace crease
