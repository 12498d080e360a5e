#include "Optimizers/Lbfgs.h"

#include "Optimizers/LineSearch.h"

namespace crease {
namespace {

LineSearchOptions line_search(const LbfgsOptions& options) {
  return {.direction = LineSearchDirection::kLbfgs,
          .memory = options.memory,
          .precondition = options.precondition,
          .first_step = options.first_step,
          .curvature_decrease = 0.9};
}

}  // namespace

Lbfgs::Lbfgs(const OptimizerOptions& stopping, const LbfgsOptions& options)
    : stopping_(stopping), options_(options) {
  check_options(stopping);
  check_options(line_search(options), "L-BFGS");
}

OptimizerResult Lbfgs::minimize(ObjectiveFunction& function, const Eigen::VectorXd& start,
                                const NullSpace* null_space,
                                const ProgressCallback& progress) const {
  return minimize_by_line_search(function, start, null_space, stopping_, line_search(options_),
                                 progress);
}

}  // namespace crease
