#include "Optimizers/SteepestDescent.h"

#include <cmath>

#include "Core/Error.h"
#include "Optimizers/Minimization.h"

namespace crease {

SteepestDescent::SteepestDescent(const OptimizerOptions& stopping,
                                 const SteepestDescentOptions& options)
    : stopping_(stopping), options_(options) {
  check_options(stopping);
  const bool good = options.first_step > 0.0 && options.sufficient_decrease > 0.0 &&
                    options.sufficient_decrease < 1.0 && options.shortening > 0.0 &&
                    options.shortening < 1.0 && options.max_shortenings >= 0;
  if (!good) {
    throw InvalidInput(message("steepest descent: need first_step > 0 (is ", options.first_step,
                               "), 0 < sufficient_decrease < 1 (", options.sufficient_decrease,
                               "), 0 < shortening < 1 (", options.shortening,
                               "), max_shortenings >= 0 (", options.max_shortenings,
                               "), max_iterations >= 0 (", stopping.max_iterations, ")."));
  }
}

OptimizerResult SteepestDescent::minimize(ObjectiveFunction& function, const Eigen::VectorXd& start,
                                          const NullSpace* null_space,
                                          const ProgressCallback& progress) const {
  Minimization run(function, start, null_space, stopping_, progress, /*with_hessian=*/false);
  const NullSpace& space = run.null_space();
  Eigen::VectorXd direction = -space.solve_gram(run.current().gradient);
  double length = 0.0;
  if (!run.stopped()) {
    length = options_.first_step / function.step_length(space.apply(direction));
  }
  while (!run.stopped()) {
    const EvaluatedPoint before = run.current();
    const double slope = before.gradient.dot(direction);
    bool accepted = false;
    for (int n = 0; n <= options_.max_shortenings && !accepted && !run.out_of_time(); ++n) {
      if (n > 0) length *= options_.shortening;
      const double value = run.evaluate_trial(before.y + length * direction).value;
      accepted = value < before.value &&
                 value <= before.value + options_.sufficient_decrease * length * slope;
    }
    if (!accepted) {
      if (!run.stopped()) run.stop(StopReason::kNoDecrease);
      break;
    }
    run.accept_trial();
    const EvaluatedPoint& after = run.current();
    const double curvature = (after.y - before.y).dot(after.gradient - before.gradient);
    const double moved = (after.x - before.x).squaredNorm();
    if (curvature > 0.0) length = moved / curvature;  // else keep the length that worked
    direction = -space.solve_gram(after.gradient);
  }
  return run.result();
}

}  // namespace crease
