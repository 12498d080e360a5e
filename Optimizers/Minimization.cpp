#include "Optimizers/Minimization.h"

#include <cmath>
#include <utility>

#include "Core/Error.h"

namespace crease {
namespace {
// A decrease below this share of the value is lost in rounding.
constexpr double kRounding = 1e-14;
}  // namespace

Minimization::Minimization(ObjectiveFunction& function, const Eigen::VectorXd& start,
                           const NullSpace* null_space, const OptimizerOptions& options,
                           const ProgressCallback& progress, bool with_hessian)
    : function_(function),
      unconstrained_(null_space == nullptr
                         ? make_null_space(NullSpaceKind::kElimination,
                                           no_constraints(function.size()), function.size())
                         : nullptr),
      null_space_(null_space == nullptr ? unconstrained_.get() : null_space),
      options_(options),
      progress_(progress),
      with_hessian_(with_hessian) {
  if (function.size() != start.size() || function.size() != null_space_->full_size()) {
    throw InvalidInput(message("minimisation: the function has ", function.size(),
                               " unknowns, the start ", start.size(), " and the null space ",
                               null_space_->full_size(), "; make them agree."));
  }
  if (with_hessian && !function.has_hessian()) {
    throw InvalidInput(
        "minimisation: Gauss-Newton needs a Hessian and the function has none; use an optimizer "
        "that "
        "needs gradients only.");
  }
  if (!start.allFinite()) throw InvalidInput("minimisation: the start is not finite.");
  current_.y = null_space_->coordinates(start);
  evaluate(current_);
  if (!std::isfinite(current_.value)) {
    throw SolverError("minimisation: the value at the start is infinite; start elsewhere.");
  }
  record({});
  if (!stopped() && current_.gradient.isZero(0.0)) stop(StopReason::kSmallGradient);
}

void Minimization::evaluate(EvaluatedPoint& at) {
  at.x = null_space_->expand(at.y);
  full_gradient_.resize(at.x.size());
  at.value = function_.evaluate(at.x, &full_gradient_, with_hessian_ ? &at.hessian : nullptr);
  if (with_hessian_) at.hessian.makeCompressed();
  ++work_.evaluations;
  check_value(at.value);
  if (std::isinf(at.value)) return;  // a trial that will be rejected
  if (full_gradient_.size() != at.x.size()) {
    throw InvalidInput(message("minimisation: the function returned a gradient of ",
                               full_gradient_.size(), " numbers for ", at.x.size(), " unknowns."));
  }
  for (Eigen::Index i = 0; i < full_gradient_.size(); ++i) {
    if (std::isfinite(full_gradient_[i])) continue;
    throw SolverError(message("minimisation: entry ", i, " of the gradient is ", full_gradient_[i],
                              " ", where(), "."));
  }
  at.gradient = null_space_->apply_transpose(full_gradient_);
}

// For messages.
std::string Minimization::where() const {
  return history_.empty() ? std::string("at the start")
                          : message("in iteration ", history_.back().iteration + 1);
}

void Minimization::check_value(double value) const {
  if (!std::isnan(value)) return;
  throw SolverError(message("minimisation: the value is not a number ", where(), "."));
}

double Minimization::value_at(const Eigen::VectorXd& y) {
  const double value = function_.evaluate(null_space_->expand(y), nullptr, nullptr);
  ++work_.evaluations;
  check_value(value);
  return value;
}

const EvaluatedPoint& Minimization::evaluate_trial(Eigen::VectorXd y) {
  trial_.y = std::move(y);
  evaluate(trial_);
  return trial_;
}

double Minimization::trial_step() const { return function_.step_length(trial_.x - current_.x); }

void Minimization::accept_trial(double damping) {
  IterationRecord next;
  next.step = trial_step();
  next.damping = damping;
  const bool enough = count_decrease(current_.value - trial_.value);
  std::swap(current_, trial_);
  record(next);
  if (stopped()) return;
  const double first_gradient = history_.front().gradient_norm;
  if (enough) {
    stop(StopReason::kSmallDecrease);
  } else if (history_.back().gradient_norm <= options_.relative_gradient * first_gradient) {
    stop(StopReason::kSmallGradient);
  } else if (next.step < options_.step_length) {
    stop(StopReason::kSmallStep);
  } else if (iterations() >= options_.max_iterations) {
    stop(StopReason::kIterationLimit);
  } else {
    out_of_time();
  }
}

void Minimization::reject_trial(double expected_decrease) {
  const double value = std::abs(current_.value);
  if (expected_decrease <= options_.relative_decrease * value && count_decrease(0.0)) {
    stop(StopReason::kSmallDecrease);
  } else if (expected_decrease <= kRounding * value) {
    stop(StopReason::kNoDecrease);
  }
}

// Whether the decrease completes the run of small ones that ends the minimisation.
bool Minimization::count_decrease(double decrease) {
  const bool small = decrease < options_.relative_decrease * std::abs(current_.value);
  small_decreases_ = small ? small_decreases_ + 1 : 0;
  return small && small_decreases_ >= options_.small_decreases;
}

void Minimization::set_linear_work(int factorizations, int linear_iterations) {
  work_.factorizations = factorizations;
  work_.linear_iterations = linear_iterations;
}

bool Minimization::out_of_time() {
  if (!stopped() && seconds() > options_.max_seconds) stop(StopReason::kTimeLimit);
  return stopped();
}

void Minimization::stop(StopReason reason) {
  if (!reason_) reason_ = reason;
}

void Minimization::record(IterationRecord record) {
  record.iteration = static_cast<int>(history_.size());
  record.value = current_.value;
  record.gradient_norm = current_.gradient.norm();
  record.evaluations = work_.evaluations - recorded_work_.evaluations;
  record.factorizations = work_.factorizations - recorded_work_.factorizations;
  record.linear_iterations = work_.linear_iterations - recorded_work_.linear_iterations;
  recorded_work_ = work_;
  record.seconds = seconds();
  history_.push_back(record);
  if (progress_ && !progress_(record)) {
    stop(StopReason::kCancelled);
  } else if (record.iteration == 0 && options_.max_iterations <= 0) {
    stop(StopReason::kIterationLimit);
  }
}

double Minimization::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_time_).count();
}

OptimizerResult Minimization::result() const {
  OptimizerResult result;
  result.x = current_.x;
  result.value = current_.value;
  result.initial_value = history_.front().value;
  result.iterations = history_.back().iteration;
  result.reason = reason_.value_or(StopReason::kIterationLimit);
  result.reason_text = to_string(result.reason);
  result.num_evaluations = work_.evaluations;
  result.num_factorizations = work_.factorizations;
  result.history = history_;
  return result;
}

}  // namespace crease
