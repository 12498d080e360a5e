#include "Optimizers/NonlinearConjugateGradient.h"

#include "Optimizers/LineSearch.h"

namespace crease {
namespace {

LineSearchOptions line_search(const NonlinearConjugateGradientOptions& options) {
  return {.direction = LineSearchDirection::kConjugateGradient,
          .precondition = options.precondition,
          .first_step = options.first_step,
          .curvature_decrease = 0.1};
}

}  // namespace

NonlinearConjugateGradient::NonlinearConjugateGradient(
    const OptimizerOptions& stopping, const NonlinearConjugateGradientOptions& options)
    : stopping_(stopping), options_(options) {
  check_options(stopping);
  check_options(line_search(options), "nonlinear conjugate gradients");
}

OptimizerResult NonlinearConjugateGradient::minimize(ObjectiveFunction& function,
                                                     const Eigen::VectorXd& start,
                                                     const NullSpace* null_space,
                                                     const ProgressCallback& progress) const {
  return minimize_by_line_search(function, start, null_space, stopping_, line_search(options_),
                                 progress);
}

}  // namespace crease
