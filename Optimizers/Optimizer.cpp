#include "Optimizers/Optimizer.h"

#include "Core/Error.h"

namespace crease {

void check_options(const OptimizerOptions& options) {
  const bool good = options.relative_decrease >= 0.0 && options.small_decreases >= 1 &&
                    options.relative_gradient >= 0.0 && options.step_length >= 0.0 &&
                    options.max_iterations >= 0 && options.max_seconds >= 0.0;
  if (good) return;
  throw InvalidInput(
      message("stopping rules of an optimizer: need relative_decrease >= 0 (is ",
              options.relative_decrease, "), small_decreases >= 1 (", options.small_decreases,
              "), relative_gradient >= 0 (", options.relative_gradient, "), step_length >= 0 (",
              options.step_length, "), max_iterations >= 0 (", options.max_iterations,
              "), max_seconds >= 0 (", options.max_seconds, ")."));
}

std::string to_string(StopReason reason) {
  switch (reason) {
    case StopReason::kSmallDecrease:
      return "the relative decrease of the value fell below its limit";
    case StopReason::kSmallGradient:
      return "the gradient fell below its limit";
    case StopReason::kSmallStep:
      return "the step became shorter than its limit";
    case StopReason::kNoDecrease:
      return "no further step lowers the value";
    case StopReason::kIterationLimit:
      return "the iteration limit was reached";
    case StopReason::kTimeLimit:
      return "the time limit was reached";
    case StopReason::kCancelled:
      return "cancelled";
  }
  return "unknown";
}

}  // namespace crease
