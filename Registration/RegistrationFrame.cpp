#include "Registration/RegistrationFrame.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "Core/Error.h"
#include "Registration/SamplesInside.h"

namespace crease {
namespace {

constexpr int kGradientIterations = 5;  // of a gradient method, where Gauss-Newton may take one

}  // namespace

template <int Dim>
void RegistrationFrame<Dim>::normalise_images() {
  compared_ = normalised(std::span<const ChannelView<Dim>>(parts_.channels()));
}

template <int Dim>
void RegistrationFrame<Dim>::find_initial_map() {
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
void RegistrationFrame<Dim>::make_channel_levels() {
  tell("binding", 0, 0, 0);
  const auto pairs = views(std::span<const Channel<Dim>>(compared_));
  channels_ = channel_levels<Dim>(
      pairs, parts_.schedule.levels,
      {.interpolation = parts_.interpolation, .smooth_finest = parts_.schedule.smooth_finest});
  num_levels_ = channels_.front().levels.size();
}

template <int Dim>
typename RegistrationFrame<Dim>::Counted RegistrationFrame<Dim>::counted_samples(
    std::size_t l, const BoundGrid<Dim>& grid,
    const std::vector<ControlPoints<Dim>>& starts) const {
  constexpr double kMargin = 2;  // pixels of the level: about what a start may be off
  const RowSubset rows = rows_of_level(l);
  Counted counted;
  for (const ChannelLevels<Dim>& channel : channels_) {
    const ImageLevel<Dim>& image = channel.levels[l];
    std::vector<float> weights = image.weights;
    for (const auto& start : starts) {
      keep_samples_inside<Dim>(grid, affine_, start, image.moving->raster(), kMargin, weights);
    }
    double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    const double all = std::accumulate(image.weights.begin(), image.weights.end(), 0.0);
    if (4 * sum < all) {  // a start that is far off: the metric says what is wrong if it stays so
      weights = image.weights;
      sum = all;
    }
    counted.measures.push_back(sum * image.fixed.raster().sample_volume());
    rows.apply(weights);
    counted.weights.push_back(std::move(weights));
  }
  return counted;
}

template <int Dim>
RowSubset RegistrationFrame<Dim>::rows_of_level(std::size_t l) const {
  const double fraction = l + 1 == num_levels_ ? 1.0 : parts_.schedule.sample_fraction;
  return {channels_.front().levels[l].fixed.raster().num_rows(), fraction,
          parts_.schedule.seed + l};
}

/// The filters are [1 3 3 1]/8 on coarse levels, [1 2 1]/4 on a smoothed finest one.
template <int Dim>
double RegistrationFrame<Dim>::correlated_measure(std::size_t l) const {
  const ImageLevel<Dim>& image = channels_.front().levels[l];
  double samples = 1;
  if (image.shrink > 1) {
    const double apart = l + 1 == num_levels_ ? 1.0 : 1 / parts_.schedule.sample_fraction;  // rows
    samples = std::pow(1.6, Dim - 1) * std::max(1.6, apart);
  } else if (parts_.schedule.smooth_finest) {
    samples = std::pow(8.0 / 3.0, Dim);
  }
  return samples * image.fixed.raster().sample_volume();
}

template <int Dim>
OptimizerOptions RegistrationFrame<Dim>::stopping_rule(bool finest, bool last,
                                                       bool in_units_of_noise,
                                                       int max_iterations) const {
  OptimizerOptions stopping;
  stopping.max_iterations = max_iterations;
  if (parts_.has_images()) {
    // Of half the noise's power, which squared differences are about, and information some five times.
    stopping.relative_decrease = (last ? 1e-3 : 3e-3) * (in_units_of_noise ? 0.2 : 1);
    stopping.small_decreases = 1;
    stopping.step_length = finest ? 0.02 : 0.1;
  } else {
    stopping.relative_decrease = 1e-10;  // iterations without images cost little
  }
  return stopping;
}

template <int Dim>
std::shared_ptr<const Optimizer> RegistrationFrame<Dim>::optimizer(
    OptimizerOptions stopping, const GaussNewtonOptions& gauss_newton) const {
  if (parts_.optimizer != nullptr) return parts_.optimizer;
  if (parts_.optimizer_kind == OptimizerKind::kGaussNewton) {
    return std::make_shared<GaussNewton>(stopping, gauss_newton);
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

template <int Dim>
void RegistrationFrame<Dim>::book(const Round& round, LevelReport& level) {
  level.iterations += round.iterations;
  level.evaluations += round.num_evaluations;
  level.factorizations += round.num_factorizations;
  level.stopped_because = result_.stopped_because = round.reason_text;
  for (const auto& record : round.history) level.energy_history.push_back(record.value);
  level.term_history.insert(level.term_history.end(), round.weighted_terms.begin(),
                            round.weighted_terms.end());
  level.term_history.resize(level.energy_history.size());  // where none are known
  result_.converged =
      round.reason != StopReason::kTimeLimit && round.reason != StopReason::kCancelled;
}

template <int Dim>
void RegistrationFrame<Dim>::warn_of_limit(std::size_t level, const OptimizerResult& round) {
  if (round.reason != StopReason::kIterationLimit) return;
  result_.warnings.push_back(message("level ", level + 1, " of ", num_levels_,
                                     " stopped at the iteration limit (", round.iterations,
                                     "); the result may still improve"));
}

template <int Dim>
void RegistrationFrame<Dim>::report_images(const std::shared_ptr<Metric<Dim>>& metric,
                                           const std::function<double(int)>& at) {
  result_.metric_before = at(0);
  const auto before = channel_values(metric, result_.metric_before);
  result_.metric_after = at(1);
  const auto after = channel_values(metric, result_.metric_after);
  result_.channels = channel_reports<Dim>(before, after);
  result_.improved = result_.metric_after < result_.metric_before;
  if (!result_.improved) {
    result_.warnings.push_back("the registration did not improve the match of the images");
  }
}

template <int Dim>
void RegistrationFrame<Dim>::report_landmarks(const Transform<Dim>& transform) {
  for (std::size_t j = 0; j < parts_.landmarks.fixed.size(); ++j) {
    result_.landmark_errors_mm.push_back(
        (transform.map(parts_.landmarks.fixed[j]) - parts_.landmarks.moving[j]).norm());
  }
}

template <int Dim>
void RegistrationFrame<Dim>::tell(const std::string& stage, std::size_t level, int iteration,
                                  double energy) {
  if (!progress_) return;
  const auto levels = static_cast<double>(num_levels_);
  RegistrationProgress state{.stage = stage,
                             .level = static_cast<int>(level) + 1,
                             .num_levels = static_cast<int>(num_levels_),
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
void RegistrationFrame<Dim>::add_time(const std::string& stage) {
  const auto now = std::chrono::steady_clock::now();
  result_.timings_s[stage] += std::chrono::duration<double>(now - last_time_).count();
  last_time_ = now;
}

template class RegistrationFrame<2>;
template class RegistrationFrame<3>;

}  // namespace crease
