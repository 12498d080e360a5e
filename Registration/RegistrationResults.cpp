#include <algorithm>

#include "Optimizers/GaussNewton.h"
#include "Registration/DeterminedParameters.h"
#include "Registration/FinerPlaces.h"
#include "Registration/RegistrationRun.h"
#include "Registration/SmoothingEnergy.h"
#include "Registration/Unfolding.h"
#include "Transforms/Energies/BendingEnergy.h"
#include "Transforms/JacobianMap.h"

// What a run makes of a minimum: weights for the next one, a map without folds, places for finer patches, the report.

namespace crease {

/// Whether the level is worth another minimisation, with other weights.
template <int Dim>
bool RegistrationRun<Dim>::renew_weights(std::size_t l, const LevelReport& level, const Phi& phi) {
  const WeightedEnergy<Dim>* smoothing = smoothing_energy(energies_);
  if (!weights_ || smoothing == nullptr || !level.terms_after.contains(smoothing->name))
    return false;
  const bool finest = l + 1 == num_levels_;
  if (finest && !parts_.schedule.require_invertible && folds(phi)) {
    return weights_->stiffen(energies_);
  }
  BendingBalance balance = image_noise(l, level.terms_after.at("image"), phi);
  balance.bending_energy = level.terms_after.at(smoothing->name);
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
                        .correlated_measure = this->correlated_measure(l),
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
  const auto term =
      std::make_shared<ImageTerm<Dim>>(level.grid, metric, affine_, this->rows_of_level(l));
  RegistrationObjective<Dim> image(pattern_, term, parts_.image_weight * weight * metric->unit(),
                                   {});
  return determined_parameters(image, *objective(level), phi, *null_space_, *solver_);
}

/// Whether the map turns tissue over at a sample of the second finest level.
template <int Dim>
bool RegistrationRun<Dim>::folds(const Phi& phi) const {
  SplineTransform<Dim> transform(parts_.basis, affine_);
  transform.set_parameters(phi);
  const std::size_t l = num_levels_ > 1 ? num_levels_ - 2 : 0;
  return jacobian_map(transform, levels_[l].grid->raster()).statistics().num_folded > 0;
}

/// Goes on at the finest level until the map is certified not to fold.
template <int Dim>
void RegistrationRun<Dim>::make_invertible(const Phi& start, Phi& phi) {
  const std::size_t l = num_levels_ - 1;
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
                    this->tell("unfolding", l, record.iteration, record.value);
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
  this->add_time("unfolding");
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
void RegistrationRun<Dim>::look_for_finer_places(const Phi& phi) {
  const auto bending = std::ranges::find(energies_, "bending", &WeightedEnergy<Dim>::name);
  if (bending == energies_.end()) return;  // nothing says what finer patches would cost
  const auto* energy = dynamic_cast<const BendingEnergy<Dim>*>(bending->energy.get());
  if (energy == nullptr) return;
  SplineTransform<Dim> transform(parts_.basis, affine_);
  transform.set_parameters(phi);
  const Level& finest = levels_.back();
  const std::size_t l = num_levels_ - 1;
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
  if (!result_.levels.empty()) result_.energies = result_.levels.back().terms_after;
  if (parts_.has_images()) {
    if (levels_.back().image == nullptr) choose_samples(num_levels_ - 1, {phi});  // cancelled
    ImageTerm<Dim>& image = *levels_.back().image;
    this->report_images(image.shared_metric(), [&](int end) {
      const ControlPoints<Dim> at = end * phi.reshaped(Dim, pattern_->size());
      return image.evaluate(at, 1, nullptr, nullptr);
    });
  }
  result_.cost = objective(levels_.back())->evaluate(phi, nullptr, nullptr);
  auto transform = std::make_shared<SplineTransform<Dim>>(parts_.basis, affine_);
  transform->set_parameters(phi);
  this->report_landmarks(*transform);
  for (const auto& energy : energies_) result_.weights[energy.name] = energy.weight;
  result_.transform = std::move(transform);
  this->add_time("report");
}

#define CREASE_INSTANTIATE(Dim)                                                                  \
  template bool RegistrationRun<Dim>::renew_weights(std::size_t, const LevelReport&,             \
                                                    const Eigen::VectorXd&);                     \
  template BendingBalance RegistrationRun<Dim>::image_noise(std::size_t, double,                 \
                                                            const Eigen::VectorXd&);             \
  template double RegistrationRun<Dim>::determined_by(                                           \
      std::size_t, const std::shared_ptr<Metric<Dim>>&, double, const Eigen::VectorXd&);         \
  template bool RegistrationRun<Dim>::folds(const Eigen::VectorXd&) const;                       \
  template void RegistrationRun<Dim>::make_invertible(const Eigen::VectorXd&, Eigen::VectorXd&); \
  template void RegistrationRun<Dim>::look_for_finer_places(const Eigen::VectorXd&);             \
  template void RegistrationRun<Dim>::report(const Eigen::VectorXd&);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease
