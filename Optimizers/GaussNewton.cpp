#include "Optimizers/GaussNewton.h"

#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Optimizers/Minimization.h"

namespace crease {
namespace {

constexpr double kMaxDamping = 1e8;
constexpr double kMinDamping = 1e-15;
constexpr double kLeastIncrease = 1e-8;  // from a damping of zero
constexpr double kDampingFactor = 4.0;

[[noreturn]] void report_bad_hessian(const Eigen::SparseMatrix<double>& H, int iteration) {
  for (int j = 0; j < H.outerSize(); ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(H, j); entry; ++entry) {
      if (std::isfinite(entry.value())) continue;
      throw SolverError(message("Gauss-Newton: entry (", entry.row(), ", ", j,
                                ") of the Hessian is ", entry.value(), " in iteration ", iteration,
                                "."));
    }
  }
  throw SolverError(message("Gauss-Newton: the Hessian is not positive definite in iteration ",
                            iteration, ", even with a relative damping of ", kMaxDamping, "."));
}

void check(const GaussNewtonOptions& options) {
  const bool good =
      options.initial_damping >= 0.0 && options.max_shortenings >= 0 && options.shortening > 0.0 &&
      options.shortening < 1.0 && options.linear_solver.cg_tolerance > 0.0 &&
      options.linear_solver.cg_tolerance < 1.0 && options.linear_solver.max_cg_iterations > 0;
  if (!good) {
    throw InvalidInput(
        message("Gauss-Newton: need initial_damping >= 0 (is ", options.initial_damping,
                "), max_shortenings >= 0 (", options.max_shortenings, "), 0 < shortening < 1 (",
                options.shortening, "), 0 < cg_tolerance < 1 (", options.linear_solver.cg_tolerance,
                "), max_cg_iterations > 0 (", options.linear_solver.max_cg_iterations, ")."));
  }
}

}  // namespace

GaussNewton::GaussNewton(const OptimizerOptions& stopping, const GaussNewtonOptions& options)
    : stopping_(stopping), options_(options) {
  check_options(stopping);
  check(options);
}

OptimizerResult GaussNewton::minimize(ObjectiveFunction& function, const Eigen::VectorXd& start,
                                      const NullSpace* null_space,
                                      const ProgressCallback& progress) const {
  Minimization run(function, start, null_space, stopping_, progress, /*with_hessian=*/true);
  const auto kept = options_.solver ? options_.solver
                                    : std::make_shared<DampedSolver>(
                                          options_.linear_solver, run.null_space().num_columns());
  DampedSolver& solver = *kept;
  solver.start_counting();
  double damping = options_.initial_damping;
  while (!run.stopped()) {
    const EvaluatedPoint& here = run.current();
    run.null_space().reduce_hessian(here.hessian, solver.hessian());
    solver.hessian_changed();
    for (bool accepted = false; !accepted && !run.stopped();) {
      const auto step = solver.solve(-here.gradient, damping);
      run.set_linear_work(solver.num_factorizations(), solver.num_cg_iterations());
      if (!step) {
        damping = std::max(kDampingFactor * damping, kLeastIncrease);
        if (damping > kMaxDamping) report_bad_hessian(here.hessian, run.iterations() + 1);
        continue;
      }
      const double length = find_decrease(run, *step);
      accepted = length > 0.0;
      if (accepted) {
        run.accept_trial(damping);
        damping = length == 1.0 ? std::max(damping / kDampingFactor, kMinDamping)
                                : std::max(damping * kDampingFactor, kLeastIncrease);
      } else {
        const double expected = -0.5 * here.gradient.dot(*step);  // of a full step
        damping = std::max(kDampingFactor * damping, kLeastIncrease);
        run.reject_trial(expected);
        if (damping > kMaxDamping) run.stop(StopReason::kNoDecrease);
      }
    }
  }
  return run.result();
}

// The share of the step at which the value falls (that point is the current trial), or 0.
double GaussNewton::find_decrease(Minimization& run, const Eigen::VectorXd& step) const {
  double length = 1.0;
  for (int shortened = 0; shortened <= options_.max_shortenings && !run.out_of_time();
       ++shortened) {
    const Eigen::VectorXd y = run.current().y + length * step;
    if (run.evaluate_trial(y).value < run.current().value) return length;
    length *= options_.shortening;
  }
  return 0.0;
}

}  // namespace crease
