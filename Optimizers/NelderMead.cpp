#include "Optimizers/NelderMead.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_multimin.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>

#include "Core/Error.h"
#include "Optimizers/Minimization.h"

namespace crease {
namespace {

using Vector = std::unique_ptr<gsl_vector, decltype(&gsl_vector_free)>;
using Minimizer = std::unique_ptr<gsl_multimin_fminimizer, decltype(&gsl_multimin_fminimizer_free)>;

// GSL gives up on infinite values, so the largest finite one stands for them.
constexpr double kInfinite = std::numeric_limits<double>::max();

// What passes through GSL's void pointer; exceptions must not cross its C frames.
struct Problem {
  const std::function<double(const Eigen::VectorXd&)>& function;
  int evaluations = 0;
  std::exception_ptr error = nullptr;

  double value(const Eigen::VectorXd& x) {
    if (error) return kInfinite;
    ++evaluations;
    try {
      const double value = function(x);
      return value < kInfinite ? std::max(value, -kInfinite) : kInfinite;  // NaN as well
    } catch (...) {
      error = std::current_exception();
      return kInfinite;
    }
  }
};

Eigen::VectorXd to_eigen(const gsl_vector* v) {
  Eigen::VectorXd x(static_cast<Eigen::Index>(v->size));
  for (std::size_t i = 0; i < v->size; ++i) x[static_cast<Eigen::Index>(i)] = gsl_vector_get(v, i);
  return x;
}

Vector to_gsl(const Eigen::VectorXd& x) {
  Vector v(gsl_vector_alloc(static_cast<std::size_t>(x.size())), &gsl_vector_free);
  for (Eigen::Index i = 0; i < x.size(); ++i)
    gsl_vector_set(v.get(), static_cast<std::size_t>(i), x[i]);
  return v;
}

void check(const Eigen::VectorXd& start, const Eigen::VectorXd& steps) {
  if (start.size() == 0 || start.size() != steps.size()) {
    throw InvalidInput(message("Nelder-Mead: ", start.size(), " parameters and ", steps.size(),
                               " steps; give one step per parameter, and at least one."));
  }
  for (Eigen::Index i = 0; i < start.size(); ++i) {
    if (std::isfinite(start[i]) && std::isfinite(steps[i]) && steps[i] != 0.0) continue;
    throw InvalidInput(message("Nelder-Mead: parameter ", i, " starts at ", start[i], " with step ",
                               steps[i], "; both must be finite, the step not 0."));
  }
}

// What moves every free unknown by one unit of step_length().
Eigen::VectorXd unit_steps(const ObjectiveFunction& function, const NullSpace& space) {
  Eigen::VectorXd steps(space.reduced_size());
  for (Eigen::Index i = 0; i < steps.size(); ++i) {
    const double length = function.step_length(space.apply(Eigen::VectorXd::Unit(steps.size(), i)));
    steps[i] = length > 0 ? 1 / length : 1.0;
  }
  return steps;
}

OptimizerOptions simplex_rules(OptimizerOptions stopping) {
  check_options(stopping);
  stopping.relative_decrease = stopping.step_length = 0.0;
  return stopping;
}

}  // namespace

NelderMeadResult nelder_mead(const std::function<double(const Eigen::VectorXd&)>& function,
                             const Eigen::VectorXd& start, const Eigen::VectorXd& steps,
                             const NelderMeadOptions& options) {
  check(start, steps);
  gsl_set_error_handler_off();
  Problem problem{function};
  NelderMeadResult result;
  result.initial_value = problem.value(start);
  if (problem.error) std::rethrow_exception(problem.error);
  if (result.initial_value == kInfinite) {
    throw SolverError(
        "Nelder-Mead: the value at the start is not a finite number; start elsewhere.");
  }

  gsl_multimin_function gsl_problem{[](const gsl_vector* x, void* data) {
                                      return static_cast<Problem*>(data)->value(to_eigen(x));
                                    },
                                    static_cast<std::size_t>(start.size()), &problem};
  const Vector first = to_gsl(start);
  const Vector edges = to_gsl(steps);
  const Minimizer minimizer(gsl_multimin_fminimizer_alloc(gsl_multimin_fminimizer_nmsimplex2,
                                                          static_cast<std::size_t>(start.size())),
                            &gsl_multimin_fminimizer_free);
  int status = gsl_multimin_fminimizer_set(minimizer.get(), &gsl_problem, first.get(), edges.get());
  while (status == GSL_SUCCESS && !problem.error && !result.converged &&
         problem.evaluations < options.max_evaluations) {
    status = gsl_multimin_fminimizer_iterate(minimizer.get());
    if (options.after_iteration &&
        !options.after_iteration(to_eigen(gsl_multimin_fminimizer_x(minimizer.get())),
                                 gsl_multimin_fminimizer_minimum(minimizer.get()))) {
      break;
    }
    result.converged = gsl_multimin_fminimizer_size(minimizer.get()) < options.size_tolerance;
  }
  if (problem.error) std::rethrow_exception(problem.error);
  result.x = to_eigen(gsl_multimin_fminimizer_x(minimizer.get()));
  result.value = gsl_multimin_fminimizer_minimum(minimizer.get());
  result.num_evaluations = problem.evaluations;
  return result;
}

NelderMead::NelderMead(const OptimizerOptions& stopping, const SimplexOptions& simplex)
    : stopping_(simplex_rules(stopping)), simplex_(simplex) {
  simplex_.last_size = std::max(simplex.last_size, stopping.step_length);
  if (simplex.first_edge > 0.0 && simplex.last_size > 0.0 && simplex.max_evaluations >= 0) return;
  throw InvalidInput(message("Nelder-Mead: need first_edge > 0 (is ", simplex.first_edge,
                             "), last_size > 0 (", simplex.last_size, "), max_evaluations >= 0 (",
                             simplex.max_evaluations, ")."));
}

OptimizerResult NelderMead::minimize(ObjectiveFunction& function, const Eigen::VectorXd& start,
                                     const NullSpace* null_space,
                                     const ProgressCallback& progress) const {
  Minimization run(function, start, null_space, stopping_, progress, /*with_hessian=*/false);
  if (run.stopped()) return run.result();
  const NullSpace& space = run.null_space();
  if (space.reduced_size() > kMostUnknowns) {
    throw InvalidInput(message("Nelder-Mead: ", space.reduced_size(), " unknowns; it is for up to ",
                               kMostUnknowns, ", take an optimizer with gradients."));
  }
  const Eigen::VectorXd first = run.current().y;
  const Eigen::VectorXd units = unit_steps(function, space);
  const auto place = [&](const Eigen::VectorXd& u) -> Eigen::VectorXd {
    return first + units.cwiseProduct(u);
  };
  NelderMeadOptions options;
  options.size_tolerance = simplex_.last_size;
  options.max_evaluations = simplex_.max_evaluations;
  options.after_iteration = [&](const Eigen::VectorXd& u, double value) {
    if (value < run.current().value && run.evaluate_trial(place(u)).value < run.current().value) {
      run.accept_trial();
    }
    return !run.out_of_time();
  };
  const auto found = nelder_mead(
      [&](const Eigen::VectorXd& u) {
        return run.out_of_time() ? run.current().value : run.value_at(place(u));
      },
      Eigen::VectorXd::Zero(first.size()),
      Eigen::VectorXd::Constant(first.size(), simplex_.first_edge), options);
  run.stop(found.converged ? StopReason::kSmallStep : StopReason::kIterationLimit);
  return run.result();
}

}  // namespace crease
