#include "Registration/RegistrationRun.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "Core/Error.h"
#include "Metrics/MetricSum.h"
#include "Metrics/TargetDisplacement.h"
#include "Optimizers/GaussNewton.h"
#include "Registration/DeterminedParameters.h"
#include "Registration/FinerPlaces.h"
#include "Registration/OpticalFlow.h"
#include "Registration/SamplesInside.h"
#include "Registration/StartingPoint.h"
#include "Registration/Unfolding.h"
#include "Transforms/Energies/BendingEnergy.h"
#include "Transforms/JacobianMap.h"

namespace crease {
namespace {

constexpr int kTrialIterations = 2;      // that decide which start is followed
constexpr int kGradientIterations = 5;   // of a gradient method, where Gauss-Newton may take one
constexpr int kLargestFlowImage = 1200;  // pixels: larger images give their flow at half the size

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
RegistrationRun<Dim>::RegistrationRun(const RegistrationParts<Dim>& parts,
                                      const RegistrationCallback& progress)
    : parts_(parts), progress_(progress) {
  check_parts();
}

template <int Dim>
void RegistrationRun<Dim>::check_parts() const {
  if (parts_.basis == nullptr) throw InvalidInput("registration: no spline basis given");
  double sum = parts_.has_images() ? parts_.image_weight : 0;
  for (const auto& energy : parts_.energies) sum += energy.weight;
  if (!(sum > 0)) {
    throw InvalidInput("registration: all weights are zero; give alpha, beta or gamma a weight");
  }
}

template <int Dim>
RegistrationResult<Dim> RegistrationRun<Dim>::execute() {
  if (parts_.has_images()) normalise_images();
  find_initial_map();
  add_time("alignment");
  make_constraints();
  add_time("constraints");
  collect_energies();
  make_solver();
  add_time("energies");
  make_levels();
  add_time("binding");
  optimise();
  return std::move(result_);
}

template <int Dim>
void RegistrationRun<Dim>::normalise_images() {
  compared_ = normalised(std::span<const ChannelView<Dim>>(parts_.channels()));
}

template <int Dim>
void RegistrationRun<Dim>::find_initial_map() {
  if (parts_.initial) {
    affine_ = *parts_.initial;
  } else if (parts_.has_images()) {
    tell("alignment", 0, 0, 0);
    const Alignment<Dim> found = align<Dim>(views(std::span<const Channel<Dim>>(compared_)),
                                            parts_.landmarks, parts_.alignment, progress_);
    affine_ = found.map;
    result_.alignment = found.report;
    if (!found.report.improved) {
      result_.warnings.push_back(
          "the initial alignment found no better map than its start, which was kept");
    }
  }
  result_.initial = affine_;
}

template <int Dim>
void RegistrationRun<Dim>::make_constraints() {
  auto constraints = make_landmark_constraints(parts_.landmarks, *parts_.basis, affine_,
                                               parts_.landmark_options, parts_.null_space);
  null_space_ = constraints.null_space;
  for (const auto& note : constraints.notes) result_.warnings.push_back(note);
  result_.free_parameters = null_space_->reduced_size();
  pattern_ = parts_.basis->pattern();
}

template <int Dim>
void RegistrationRun<Dim>::collect_energies() {
  if (parts_.schedule.adapt_weights && parts_.has_images()) {
    weights_.emplace(parts_.landmark_options.weight, parts_.basis->mean_edge_length());
  }
  for (const auto& [name, weight, factory] : parts_.energies) {
    energies_.push_back({name, weight, factory(*parts_.basis, affine_)});
  }
  if (auto soft =
          soft_landmark_energy(parts_.landmarks, *parts_.basis, affine_, parts_.landmark_options)) {
    energies_.push_back({"landmarks", parts_.landmark_options.weight, std::move(soft)});
  }
}

template <int Dim>
void RegistrationRun<Dim>::make_solver() {
  LinearSolverOptions options;
  // A scalar factor does not see how rigidity couples coordinates; the factor of an earlier Hessian serves
  // while bodies turn little.
  const bool coupled = std::ranges::any_of(
      energies_, [](const auto& energy) { return energy.energy->couples_coordinates(); });
  if (coupled) {
    options.kind = LinearSolver::kPreconditionedCg;
    options.max_cg_iterations = 6;
  }
  if (!parts_.has_images()) options.kind = LinearSolver::kDirect;
  solver_ = std::make_shared<DampedSolver>(options, null_space_->num_columns());
}

template <int Dim>
void RegistrationRun<Dim>::make_levels() {
  if (!parts_.has_images()) {
    levels_.resize(1);
    return;
  }
  tell("binding", 0, 0, 0);
  const auto pairs = views(std::span<const Channel<Dim>>(compared_));
  channels_ = channel_levels<Dim>(
      pairs, parts_.schedule.levels,
      {.interpolation = parts_.interpolation, .smooth_finest = parts_.schedule.smooth_finest});
  double factor = 1;
  levels_.resize(channels_.front().levels.size());
  for (std::size_t l = levels_.size(); l-- > 0;) {
    const ImageLevel<Dim>& image = channels_.front().levels[l];
    Level& level = levels_[l];
    level.shrink = image.shrink;
    level.bending_factor = factor;
    level.grid = parts_.basis->bind(image.fixed.raster());
    for (auto& channel : channels_) keep_samples_in_domain(*level.grid, channel.levels[l].weights);
    factor *= parts_.schedule.level_bending;
  }
}

/// How many samples share the noise of one, by the filters of the pyramid: [1 3 3 1]/8 on coarse levels,
/// [1 2 1]/4 on a smoothed finest one.
template <int Dim>
double RegistrationRun<Dim>::correlated_samples(std::size_t level) const {
  if (levels_[level].shrink > 1) {
    const bool finest = level + 1 == levels_.size();
    const double apart = finest ? 1.0 : 1 / parts_.schedule.sample_fraction;  // rows
    return std::pow(1.6, Dim - 1) * std::max(1.6, apart);
  }
  return parts_.schedule.smooth_finest ? std::pow(8.0 / 3.0, Dim) : 1.0;
}

/// Samples that a start maps outside the moving image, or to its very border, have nothing to be
/// compared with: they do not count at this level. All starts are judged by the same samples, and the
/// choice is kept for the whole level, so that the number of samples never jumps.
template <int Dim>
void RegistrationRun<Dim>::choose_samples(std::size_t l, const std::vector<Phi>& starts) {
  constexpr double kMargin = 2;  // pixels of the level: about what a start may be off
  if (!parts_.has_images()) return;
  Level& level = levels_[l];
  const double volume = level.grid->raster().sample_volume();
  const RowSubset rows = rows_of_level(l);
  std::vector<std::vector<float>> all_weights;
  level.counted_measures.clear();
  for (const ChannelLevels<Dim>& channel : channels_) {
    const ImageLevel<Dim>& image = channel.levels[l];
    std::vector<float> weights = image.weights;
    for (const Phi& start : starts) {
      keep_samples_inside<Dim>(*level.grid, affine_, start.reshaped(Dim, pattern_->size()),
                               image.moving->raster(), kMargin, weights);
    }
    double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    const double all = std::accumulate(image.weights.begin(), image.weights.end(), 0.0);
    if (4 * sum < all) {  // a start that is far off: the metric says what is wrong if it stays so
      weights = image.weights;
      sum = all;
    }
    level.counted_measures.push_back(sum * volume);
    rows.apply(weights);
    all_weights.push_back(std::move(weights));
  }
  level.correlated_measure = volume * correlated_samples(l);
  std::shared_ptr<Metric<Dim>> metric = channel_metric<Dim>(channels_, l, std::move(all_weights));
  level.image_weight = parts_.image_weight * metric->unit();
  level.noise_floor = metric->noise_power()
                          ? -std::numeric_limits<double>::infinity()
                          : 1e-11 * parts_.image_weight * level.counted_measures.front();
  level.image = std::make_shared<ImageTerm<Dim>>(level.grid, std::move(metric), affine_, rows);
}

/// The rows of samples that are looked at: all of them at the finest level.
template <int Dim>
RowSubset RegistrationRun<Dim>::rows_of_level(std::size_t l) const {
  const double fraction = l + 1 == levels_.size() ? 1.0 : parts_.schedule.sample_fraction;
  return {levels_[l].grid->raster().num_rows(), fraction, parts_.schedule.seed + l};
}

template <int Dim>
std::unique_ptr<RegistrationObjective<Dim>> RegistrationRun<Dim>::objective(
    const Level& level) const {
  auto energies = energies_;
  for (auto& energy : energies) {
    if (energy.name == "bending") energy.weight *= level.bending_factor;
  }
  return std::make_unique<RegistrationObjective<Dim>>(pattern_, level.image, level.image_weight,
                                                      std::move(energies));
}

/// Weighted least squares to a dense optical flow of each channel, smooth and rigid as the energies ask for, within the
/// constraints.
template <int Dim>
typename RegistrationRun<Dim>::Phi RegistrationRun<Dim>::fitted_to_flow(
    const Phi& near, const std::vector<std::size_t>& similar) {
  if constexpr (Dim == 2) {
    std::size_t l = levels_.size() - 1;
    const auto width = [&] { return std::ranges::max(levels_[l].grid->raster().size); };
    while (l > 0 && width() > kLargestFlowImage) --l;
    std::vector<MetricSum<2>::Channel> targets;
    for (std::size_t c : similar) {
      const ImageLevel<2>& image = channels_[c].levels[l];
      const FlowField flow = optical_flow(image.fixed, image.weights, *image.moving, affine_);
      targets.push_back(
          {std::make_shared<TargetDisplacement<2>>(flow.raster, flow.displacement, flow.weights),
           channels_[c].weight});
    }
    ImageTerm<2> fit(levels_[l].grid, std::make_shared<MetricSum<2>>(std::move(targets)), affine_);
    const double pixel = compared_.front().fixed.raster().spacing.minCoeff();
    auto energies = energies_;
    for (auto& energy : energies) {
      energy.weight = energy.name == "bending" ? 10 * std::pow(pixel, 4) : 100 * pixel * pixel;
    }
    return StartingPoint<2>(pattern_, *null_space_, energies).fitted_to(fit, near);
  }
  return near;
}

/// Those whose metrics expect similar intensities.
template <int Dim>
std::vector<std::size_t> RegistrationRun<Dim>::similar_channels() const {
  std::vector<std::size_t> similar;
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const ImageLevel<Dim>& coarsest = channels_[c].levels.front();
    const auto metric = channels_[c].metric(metric_input(coarsest, coarsest.weights));
    if (channels_[c].weight > 0 && metric->expects_similar_intensities()) similar.push_back(c);
  }
  return similar;
}

template <int Dim>
std::vector<typename RegistrationRun<Dim>::Phi> RegistrationRun<Dim>::starts() {
  std::vector<Phi> candidates;
  if (parts_.start != nullptr) {
    const SplineTransform<Dim>& map = *parts_.start;
    return {StartingPoint<Dim>(pattern_, *null_space_, energies_)
                .nearest_to(*parts_.basis, [&](const Point<Dim>& x) -> Vector<Dim> {
                  return map.map(x) - affine_(x);
                })};
  }
  const bool pulled = null_space_->rank() > 0 || energies_.size() > parts_.energies.size();
  candidates.push_back(pulled ? StartingPoint<Dim>(pattern_, *null_space_, energies_).smoothest()
                              : Phi::Zero(null_space_->full_size()));
  if (Dim == 2 && parts_.schedule.optical_flow) {
    const auto similar = similar_channels();
    if (!similar.empty()) candidates.push_back(fitted_to_flow(candidates.front(), similar));
  }
  return candidates;
}

template <int Dim>
std::shared_ptr<const Optimizer> RegistrationRun<Dim>::optimizer_of(std::size_t level,
                                                                    int max_iterations) {
  if (parts_.optimizer != nullptr) return parts_.optimizer;
  OptimizerOptions stopping;
  stopping.max_iterations = max_iterations;
  if (parts_.has_images()) {
    const bool finest = level + 1 == levels_.size();
    const bool last = finest && (!weights_ || weights_->num_balancings() >= std::ssize(levels_));
    // Of half the noise's power, which squared differences are about, and information some five times.
    const bool in_units_of_noise = levels_[level].image->metric().noise_power().has_value();
    stopping.relative_decrease = (last ? 1e-3 : 3e-3) * (in_units_of_noise ? 0.2 : 1);
    stopping.small_decreases = 1;
    stopping.step_length = finest ? 0.02 : 0.1;
  } else {
    stopping.relative_decrease = 1e-10;  // iterations without images cost little
  }
  if (parts_.optimizer_kind == OptimizerKind::kGaussNewton) {
    GaussNewtonOptions options;
    options.solver = solver_;
    return std::make_shared<GaussNewton>(stopping, options);
  }
  // Steps of gradient methods vary in length and worth.
  stopping.max_iterations *= kGradientIterations;
  stopping.small_decreases = 2;
  if (parts_.optimizer_kind == OptimizerKind::kSteepestDescent) {
    stopping.relative_decrease *= 0.1;
    stopping.small_decreases = 3;
    stopping.step_length = 0;
  }
  return make_optimizer(parts_.optimizer_kind, stopping);
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
  book(best, level);
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
    tell("level", level, record.iteration, record.value);
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

/// Books one minimisation of a level.
template <int Dim>
void RegistrationRun<Dim>::book(const Round& round, LevelReport& level) {
  level.iterations += round.iterations;
  level.evaluations += round.num_evaluations;
  level.factorizations += round.num_factorizations;
  level.stopped_because = result_.stopped_because = round.reason_text;
  for (const auto& record : round.history) level.energy_history.push_back(record.value);
  level.term_history.insert(level.term_history.end(), round.weighted_terms.begin(),
                            round.weighted_terms.end());
  result_.converged =
      round.reason != StopReason::kTimeLimit && round.reason != StopReason::kCancelled;
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
    book(round, level);
    if (round.reason == StopReason::kIterationLimit) {
      result_.warnings.push_back(message("level ", l + 1, " of ", levels_.size(),
                                         " stopped at the iteration limit (", round.iterations,
                                         "); the result may still improve"));
    }
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

/// Whether the level is worth another minimisation, with other weights.
template <int Dim>
bool RegistrationRun<Dim>::renew_weights(std::size_t l, const LevelReport& level, const Phi& phi) {
  if (!weights_ || !level.terms_after.contains("bending")) return false;
  const bool finest = l + 1 == levels_.size();
  if (finest && !parts_.schedule.require_invertible && folds(phi)) {
    return weights_->stiffen(energies_);
  }
  BendingBalance balance = image_noise(l, level.terms_after.at("image"), phi);
  balance.bending_energy = level.terms_after.at("bending");
  return weights_->balance(balance, finest, energies_);
}

/// What each channel says about noise, at the point of the last evaluation of the level's images, whose value is
/// given.
template <int Dim>
BendingBalance RegistrationRun<Dim>::image_noise(std::size_t l, double value, const Phi& phi) {
  std::vector<BendingBalance> channels;
  std::vector<double> weights;
  const auto values = channel_values(levels_[l].image->shared_metric(), value);
  const auto& measures = levels_[l].counted_measures;  // one for all metrics of a single pair
  for (std::size_t c = 0; c < values.size(); ++c) {
    const auto& [metric, weight, own_value] = values[c];
    if (weight == 0) continue;  // says nothing
    channels.push_back({.image_energy = metric->unit() * own_value,
                        .noise_power = metric->noise_power(),
                        .counted_measure = measures[std::min(c, measures.size() - 1)],
                        .correlated_measure = levels_[l].correlated_measure,
                        .determined_parameters = determined_by(l, metric, weight, phi)});
    weights.push_back(weight);
  }
  return combined(channels, weights);
}

/// How many parameters one channel of a level determines.
template <int Dim>
double RegistrationRun<Dim>::determined_by(std::size_t l,
                                           const std::shared_ptr<Metric<Dim>>& metric,
                                           double weight, const Phi& phi) {
  const Level& level = levels_[l];
  const auto term = std::make_shared<ImageTerm<Dim>>(level.grid, metric, affine_, rows_of_level(l));
  RegistrationObjective<Dim> image(pattern_, term, parts_.image_weight * weight * metric->unit(),
                                   {});
  return determined_parameters(image, *objective(level), phi, *null_space_, *solver_);
}

/// Whether the map turns tissue over at a sample of the second finest level.
template <int Dim>
bool RegistrationRun<Dim>::folds(const Phi& phi) const {
  SplineTransform<Dim> transform(parts_.basis, affine_);
  transform.set_parameters(phi);
  const std::size_t l = levels_.size() > 1 ? levels_.size() - 2 : 0;
  return jacobian_map(transform, levels_[l].grid->raster()).statistics().num_folded > 0;
}

/// Goes on at the finest level until the map is certified not to fold.
template <int Dim>
void RegistrationRun<Dim>::make_invertible(const Phi& start, Phi& phi) {
  const std::size_t l = levels_.size() - 1;
  GaussNewtonOptions options;
  options.solver = std::make_shared<DampedSolver>(
      LinearSolverOptions{.kind = LinearSolver::kPreconditionedCg, .max_cg_iterations = 6},
      null_space_->num_columns());
  const GaussNewton optimizer(
      {.relative_decrease = 1e-3, .small_decreases = 1, .max_iterations = 30}, options);
  const auto minimise = [&](bool images, const std::shared_ptr<const Energy<Dim>>& folding,
                            double weight, const Phi& from) {
    auto energies = energies_;
    energies.push_back({"folding", weight, folding});
    RegistrationObjective<Dim> cost(pattern_, images ? levels_[l].image : nullptr,
                                    levels_[l].image_weight, std::move(energies));
    return optimizer
        .minimize(cost, from, null_space_.get(),
                  [&](const IterationRecord& record) {
                    tell("unfolding", l, record.iteration, record.value);
                    return !cancelled_;
                  })
        .x;
  };
  Unfolding<Dim> unfolding(
      parts_.basis, affine_,
      {.with_images = [&](const auto& folding, double weight,
                          const Phi& from) { return minimise(true, folding, weight, from); },
       .without_images = [&](const auto& folding, double weight,
                             const Phi& from) { return minimise(false, folding, weight, from); },
       .value =
           [&](const Phi& at, Phi* curvature) {
             Eigen::SparseMatrix<double> hessian;
             const double value =
                 objective(levels_[l])
                     ->evaluate(at, nullptr, curvature != nullptr ? &hessian : nullptr);
             if (curvature != nullptr) *curvature = hessian.diagonal();
             return value;
           }});
  UnfoldingReport report;
  if (parts_.has_images()) {
    report.folded_metric =
        levels_[l].image->evaluate(phi.reshaped(Dim, pattern_->size()), 1, nullptr, nullptr);
  }
  UnfoldingResult<Dim> found = unfolding.run(phi, start);
  add_time("unfolding");
  if (found.rounds == 0) return;
  phi = std::move(found.phi);
  result_.levels.back().terms_after = terms_at(l, phi);
  report.rounds = found.rounds;
  report.weight = found.folding_weight;
  report.share = found.share;
  report.certified = found.certificate.certified();
  result_.unfolding = report;
}

template <int Dim>
void RegistrationRun<Dim>::optimise() {
  tell("start", 0, 0, 0);
  std::vector<Phi> candidates = starts();
  const Phi start = candidates.front();
  add_time("start");
  for (std::size_t l = 0; l < levels_.size() && !cancelled_; ++l) {
    choose_samples(l, candidates);
    candidates = {solve_level(l, candidates)};
  }
  Phi& phi = candidates.front();
  if (result_.levels.size() == levels_.size()) keep_better(start, phi);
  add_time("optimization");
  if (parts_.schedule.require_invertible && !cancelled_) make_invertible(start, phi);
  if (parts_.look_for_finer_places && parts_.has_images() && !cancelled_) {
    look_for_finer_places(phi);
    add_time("finer places");
  }
  report(phi);
}

template <int Dim>
void RegistrationRun<Dim>::look_for_finer_places(const Phi& phi) {
  const auto bending = std::ranges::find(energies_, "bending", &WeightedEnergy<Dim>::name);
  if (bending == energies_.end())
    return;  // nothing says how much patches of half the size would cost
  const auto* energy = dynamic_cast<const BendingEnergy<Dim>*>(bending->energy.get());
  if (energy == nullptr) return;
  SplineTransform<Dim> transform(parts_.basis, affine_);
  transform.set_parameters(phi);
  const Level& finest = levels_.back();
  const std::size_t l = levels_.size() - 1;
  const double noise = image_noise(l, terms_at(l, phi).at("image"), phi).noise_density();
  result_.finer_places = finer_places<Dim>({.transform = transform,
                                            .grid = finest.grid,
                                            .metric = finest.image->shared_metric(),
                                            .image_weight = finest.image_weight,
                                            .bending_weight = bending->weight,
                                            .rigid = energy->rigid(),
                                            .noise_density = parts_.image_weight * noise});
}

template <int Dim>
void RegistrationRun<Dim>::report(const Phi& phi) {
  auto transform = std::make_shared<SplineTransform<Dim>>(parts_.basis, affine_);
  transform->set_parameters(phi);
  if (!result_.levels.empty()) result_.energies = result_.levels.back().terms_after;
  if (levels_.back().image != nullptr || !parts_.has_images()) {
    result_.cost = objective(levels_.back())->evaluate(phi, nullptr, nullptr);
  }
  if (parts_.has_images()) {
    if (levels_.back().image == nullptr) choose_samples(levels_.size() - 1, {phi});  // cancelled
    const ControlPoints<Dim> none = ControlPoints<Dim>::Zero(Dim, pattern_->size());
    ImageTerm<Dim>& image = *levels_.back().image;
    result_.metric_before = image.evaluate(none, 1, nullptr, nullptr);
    const auto before = channel_values(image.shared_metric(), result_.metric_before);
    result_.metric_after = image.evaluate(phi.reshaped(Dim, pattern_->size()), 1, nullptr, nullptr);
    const auto after = channel_values(image.shared_metric(), result_.metric_after);
    result_.channels = channel_reports<Dim>(before, after);
    result_.improved = result_.metric_after < result_.metric_before;
    if (!result_.improved) {
      result_.warnings.push_back("the registration did not improve the match of the images");
    }
  }
  for (std::size_t j = 0; j < parts_.landmarks.fixed.size(); ++j) {
    result_.landmark_errors_mm.push_back(
        (transform->map(parts_.landmarks.fixed[j]) - parts_.landmarks.moving[j]).norm());
  }
  for (const auto& energy : energies_) result_.weights[energy.name] = energy.weight;
  result_.transform = std::move(transform);
  add_time("report");
}

template <int Dim>
void RegistrationRun<Dim>::tell(const std::string& stage, std::size_t level, int iteration,
                                double energy) {
  if (!progress_) return;
  const double levels = std::max<double>(1, static_cast<double>(levels_.size()));
  RegistrationProgress state{.stage = stage,
                             .level = static_cast<int>(level) + 1,
                             .num_levels = static_cast<int>(levels_.size()),
                             .iteration = iteration,
                             .energy = energy};
  // A level counts by its pixels, iterations within it towards a usual number of ten.
  if (stage == "level") {
    const double share = std::pow(0.25, levels - 1 - static_cast<double>(level)) * 0.7;
    state.fraction = 0.2 + share * (0.25 + 0.75 * std::min(1.0, iteration / 10.0));
  }
  if (!progress_(state)) cancelled_ = true;
}

template <int Dim>
void RegistrationRun<Dim>::add_time(const std::string& stage) {
  const auto now = std::chrono::steady_clock::now();
  result_.timings_s[stage] += std::chrono::duration<double>(now - last_time_).count();
  last_time_ = now;
}

template class RegistrationRun<2>;
template class RegistrationRun<3>;

}  // namespace crease
