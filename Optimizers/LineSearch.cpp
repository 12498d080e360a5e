#include "Optimizers/LineSearch.h"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "Core/Error.h"
#include "Optimizers/Minimization.h"
#include "Optimizers/Substitution.h"

namespace crease {
namespace {

using ConstVector = Eigen::Map<const Eigen::VectorXd>;

// One call of Ceres, from the current point of the run: Y = Y0 + scale R^-1 Z, starting at Z = 0.
class Search {
 public:
  Search(Minimization& run, const Substitution& substitution, double scale)
      : run_(run),
        substitution_(substitution),
        scale_(scale),
        origin_(run.current().y),
        current_z_(Eigen::VectorXd::Zero(origin_.size())),
        trial_z_(current_z_) {}

  // What Ceres calls; exceptions wait until it has returned. False: shorten the step.
  bool evaluate(const ConstVector& z, double* value, double* gradient) {
    if (error_ != nullptr || run_.out_of_time()) return false;
    try {
      const EvaluatedPoint& at = z == current_z_ ? run_.current() : trial(z);
      if (!std::isfinite(at.value)) return false;
      *value = at.value;
      if (gradient != nullptr) {
        Eigen::Map<Eigen::VectorXd>(gradient, z.size()) =
            scale_ * substitution_.gradient(at.gradient);
      }
      return true;
    } catch (...) {
      error_ = std::current_exception();
      return false;
    }
  }

  // Makes the point that the line search has chosen the current one. False: the run is over.
  bool accept(const ConstVector& z) {
    if (error_ != nullptr || run_.stopped()) return false;
    if (z == current_z_) return true;
    try {
      // The search may have gone back to a trial before the last one.
      if (z != trial_z_) trial(z);
      if (!(run_.trial().value < run_.current().value)) return false;
      run_.accept_trial();
      current_z_ = z;
    } catch (...) {
      error_ = std::current_exception();
    }
    return error_ == nullptr && !run_.stopped();
  }

  void rethrow() const {
    if (error_ != nullptr) std::rethrow_exception(error_);
  }
  Eigen::Index size() const { return origin_.size(); }

 private:
  const EvaluatedPoint& trial(const ConstVector& z) {
    trial_z_ = z;
    return run_.evaluate_trial(origin_ + scale_ * substitution_.step(z));
  }

  Minimization& run_;
  const Substitution& substitution_;
  double scale_;
  Eigen::VectorXd origin_, current_z_, trial_z_;
  std::exception_ptr error_ = nullptr;
};

class Function final : public ceres::FirstOrderFunction {
 public:
  explicit Function(Search& search) : search_(search) {}
  bool Evaluate(const double* z, double* value, double* gradient) const override {
    return search_.evaluate(ConstVector(z, search_.size()), value, gradient);
  }
  int NumParameters() const override { return static_cast<int>(search_.size()); }

 private:
  Search& search_;
};

class Accept final : public ceres::IterationCallback {
 public:
  Accept(Search& search, const Eigen::VectorXd& z) : search_(search), z_(z) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return search_.accept(ConstVector(z_.data(), z_.size())) ? ceres::SOLVER_CONTINUE
                                                             : ceres::SOLVER_ABORT;
  }

 private:
  Search& search_;
  const Eigen::VectorXd& z_;
};

// While it lives, Ceres does not warn on the error stream of restarts, which are part of the method.
class Silence {
 public:
  Silence() { FLAGS_minloglevel = google::GLOG_FATAL; }
  ~Silence() { FLAGS_minloglevel = level_; }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  int level_ = FLAGS_minloglevel;
};

ceres::GradientProblemSolver::Options ceres_options(const LineSearchOptions& options) {
  ceres::GradientProblemSolver::Options ceres;
  ceres.line_search_direction_type = options.direction == LineSearchDirection::kLbfgs
                                         ? ceres::LBFGS
                                         : ceres::NONLINEAR_CONJUGATE_GRADIENT;
  ceres.nonlinear_conjugate_gradient_type = ceres::POLAK_RIBIERE;
  ceres.line_search_type = ceres::WOLFE;
  ceres.max_lbfgs_rank = options.memory;
  ceres.use_approximate_eigenvalue_bfgs_scaling = true;
  ceres.line_search_sufficient_curvature_decrease = options.curvature_decrease;
  // The rules of the run stop it, not Ceres'.
  ceres.max_num_iterations = std::numeric_limits<int>::max();
  ceres.function_tolerance = ceres.gradient_tolerance = ceres.parameter_tolerance = 0.0;
  ceres.logging_type = ceres::SILENT;
  ceres.update_state_every_iteration = true;
  return ceres;
}

// Ceres' first trial is Z = -min(1, 1 / |G|) G, |G| the largest entry of the gradient in Z: the scale that
// makes it the step -length R^-1 R^-T g in Y.
double scale_for(double length, double largest_entry) {
  return length * largest_entry * largest_entry >= 1.0 ? length * largest_entry : std::sqrt(length);
}

double first_scale(const Minimization& run, const ObjectiveFunction& function,
                   const Substitution& substitution, double first_step) {
  const Eigen::VectorXd gradient = substitution.gradient(run.current().gradient);
  double length = 1.0;  // of the step that is Newton's if P is the Hessian
  if (!substitution.preconditioned()) {
    length = first_step / function.step_length(run.null_space().apply(substitution.step(gradient)));
  }
  return scale_for(length, gradient.cwiseAbs().maxCoeff());
}

}  // namespace

void check_options(const LineSearchOptions& options, const char* method) {
  const bool good = options.memory >= 1 && options.first_step > 0.0 &&
                    options.curvature_decrease > 1e-4 && options.curvature_decrease < 1.0;
  if (good) return;
  throw InvalidInput(message(
      method, ": need memory >= 1 (is ", options.memory, "), first_step > 0 (", options.first_step,
      "), 1e-4 < curvature_decrease < 1 (", options.curvature_decrease, ")."));
}

OptimizerResult minimize_by_line_search(ObjectiveFunction& function, const Eigen::VectorXd& start,
                                        const NullSpace* null_space,
                                        const OptimizerOptions& stopping,
                                        const LineSearchOptions& options,
                                        const ProgressCallback& progress) {
  Minimization run(function, start, null_space, stopping, progress, /*with_hessian=*/false);
  if (run.stopped()) return run.result();
  const Substitution substitution(function, run.current().x, run.null_space(),
                                  options.precondition);
  run.set_linear_work(1, 0);
  // A search that breaks down begins anew without its memory, as long as that leads on.
  while (!run.stopped()) {
    const int iterations = run.iterations();
    Search search(run, substitution, first_scale(run, function, substitution, options.first_step));
    Eigen::VectorXd z = Eigen::VectorXd::Zero(search.size());
    Accept accept(search, z);
    auto ceres = ceres_options(options);
    ceres.callbacks.push_back(&accept);
    const ceres::GradientProblem problem(new Function(search));
    ceres::GradientProblemSolver::Summary summary;
    const Silence silence;
    ceres::Solve(ceres, problem, z.data(), &summary);
    search.accept(ConstVector(z.data(), z.size()));  // one that ended Ceres without a callback
    search.rethrow();
    if (!run.stopped() && run.iterations() == iterations) run.stop(StopReason::kNoDecrease);
  }
  return run.result();
}

}  // namespace crease
