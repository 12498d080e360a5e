#include <cmath>
#include <limits>

#include "Registration/RegistrationRun.h"

// Minimising on the levels of a run.

namespace crease {
namespace {

constexpr int kTrialIterations = 2;  // that decide which start is followed

/// The weighted terms that the record's value sums up; none when the optimizer has evaluated another
/// point since.
template <int Dim>
std::map<std::string, double> terms_of(const IterationRecord& record,
                                       const RegistrationObjective<Dim>& cost) {
  auto terms = cost.weighted_terms();
  double sum = 0;
  for (const auto& [name, term] : terms) sum += term;
  constexpr double kRounding = 1e-9;
  if (!(std::abs(sum - record.value) <= kRounding * std::abs(record.value))) terms.clear();
  return terms;
}

}  // namespace

template <int Dim>
std::shared_ptr<const Optimizer> RegistrationRun<Dim>::optimizer_of(std::size_t level,
                                                                    int max_iterations) {
  const bool finest = level + 1 == num_levels_;
  const bool last =
      finest && (!weights_ || weights_->num_balancings() >= static_cast<int>(num_levels_));
  const bool in_units_of_noise =
      parts_.has_images() && levels_[level].image->metric().noise_power().has_value();
  GaussNewtonOptions options;
  options.solver = solver_;
  return this->optimizer(this->stopping_rule(finest, last, in_units_of_noise, max_iterations),
                         options);
}

/// The first whole minimisation of a level. Of several starts the one is followed from which a few
/// iterations lead to the lowest cost; a given optimizer goes on to its end from each.
template <int Dim>
typename RegistrationRun<Dim>::Round RegistrationRun<Dim>::minimise_from(
    const std::vector<Phi>& starts, std::size_t l, LevelReport& level) {
  if (starts.size() == 1) return optimise_level(l, starts.front(), optimizer_of(l));
  Round best;
  best.value = std::numeric_limits<double>::infinity();
  for (const Phi& start : starts) {
    Round found = optimise_level(l, start, optimizer_of(l, kTrialIterations));
    if (found.value < best.value) best = std::move(found);
  }
  if (parts_.optimizer != nullptr || cancelled_) return best;
  this->book(best, level);
  return optimise_level(l, best.x, optimizer_of(l));
}

template <int Dim>
typename RegistrationRun<Dim>::Round RegistrationRun<Dim>::optimise_level(
    std::size_t level, const Phi& start, const std::shared_ptr<const Optimizer>& optimizer) {
  const auto cost = objective(levels_[level]);
  const double value = cost->evaluate(start, nullptr, nullptr);
  if (value <= levels_[level].noise_floor) {
    Round rest;
    rest.x = start;
    rest.value = rest.initial_value = value;
    rest.reason = StopReason::kNoDecrease;
    rest.reason_text = "the images already match to rounding";
    return rest;
  }
  Round round;
  const auto follow = [&](const IterationRecord& record) {
    this->tell("level", level, record.iteration, record.value);
    round.weighted_terms.push_back(terms_of(record, *cost));
    return !cancelled_;
  };
  static_cast<OptimizerResult&>(round) =
      optimizer->minimize(*cost, start, null_space_.get(), follow);
  return round;
}

template <int Dim>
std::map<std::string, double> RegistrationRun<Dim>::terms_at(std::size_t level, const Phi& phi) {
  const auto cost = objective(levels_[level]);
  cost->evaluate(phi, nullptr, nullptr);
  return cost->terms();
}

/// Minimises on a level, anew as long as its weights change.
template <int Dim>
typename RegistrationRun<Dim>::Phi RegistrationRun<Dim>::solve_level(
    std::size_t l, const std::vector<Phi>& starts) {
  LevelReport level;
  level.shrink = levels_[l].shrink;
  level.terms_before = terms_at(l, starts.front());
  Round round = minimise_from(starts, l, level);
  while (true) {
    this->book(round, level);
    this->warn_of_limit(l, round);
    level.terms_after = terms_at(l, round.x);
    if (cancelled_ || !renew_weights(l, level, round.x)) break;
    round = optimise_level(l, round.x, optimizer_of(l));
  }
  result_.levels.push_back(std::move(level));
  return std::move(round.x);
}

/// Coarse levels may lead astray: no result is worse than the start.
template <int Dim>
void RegistrationRun<Dim>::keep_better(const Phi& start, Phi& phi) {
  constexpr double kRounding = 1e-6;
  const auto cost = objective(levels_.back());
  const double at_start = cost->evaluate(start, nullptr, nullptr);
  const auto terms = cost->terms();
  if (cost->evaluate(phi, nullptr, nullptr) <= at_start + kRounding * std::abs(at_start)) return;
  phi = start;
  LevelReport& finest = result_.levels.back();
  finest.terms_after = terms;
  finest.stopped_because = result_.stopped_because = "no better map than the start was found";
}

#define CREASE_INSTANTIATE(Dim)                                                                    \
  template std::shared_ptr<const Optimizer> RegistrationRun<Dim>::optimizer_of(std::size_t, int);  \
  template typename RegistrationRun<Dim>::Round RegistrationRun<Dim>::minimise_from(               \
      const std::vector<Eigen::VectorXd>&, std::size_t, LevelReport&);                             \
  template typename RegistrationRun<Dim>::Round RegistrationRun<Dim>::optimise_level(              \
      std::size_t, const Eigen::VectorXd&, const std::shared_ptr<const Optimizer>&);               \
  template std::map<std::string, double> RegistrationRun<Dim>::terms_at(std::size_t,               \
                                                                        const Eigen::VectorXd&);   \
  template Eigen::VectorXd RegistrationRun<Dim>::solve_level(std::size_t,                          \
                                                             const std::vector<Eigen::VectorXd>&); \
  template void RegistrationRun<Dim>::keep_better(const Eigen::VectorXd&, Eigen::VectorXd&);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease
