#include "Registration/RegistrationRun.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "Core/Error.h"
#include "Registration/SamplesInside.h"
#include "Registration/SmoothingEnergy.h"

// The stages of a run, and what is made before the first minimisation.

namespace crease {

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
  if (parts_.has_images()) this->normalise_images();
  this->find_initial_map();
  this->add_time("alignment");
  make_constraints();
  this->add_time("constraints");
  collect_energies();
  make_solver();
  this->add_time("energies");
  make_levels();
  this->add_time("binding");
  optimise();
  return std::move(result_);
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
  this->make_channel_levels();
  double factor = 1;
  levels_.resize(num_levels_);
  for (std::size_t l = num_levels_; l-- > 0;) {
    const ImageLevel<Dim>& image = channels_.front().levels[l];
    Level& level = levels_[l];
    level.shrink = image.shrink;
    level.bending_factor = factor;
    level.grid = parts_.basis->bind(image.fixed.raster());
    for (auto& channel : channels_) keep_samples_in_domain(*level.grid, channel.levels[l].weights);
    factor *= parts_.schedule.level_bending;
  }
}

/// Samples that a start maps outside the moving image, or to its very border, have nothing to be
/// compared with: they do not count at this level. All starts are judged by the same samples, and the
/// choice is kept for the whole level, so that the number of samples never jumps.
template <int Dim>
void RegistrationRun<Dim>::choose_samples(std::size_t l, const std::vector<Phi>& starts) {
  if (!parts_.has_images()) return;
  Level& level = levels_[l];
  std::vector<ControlPoints<Dim>> control_points;
  for (const Phi& start : starts) {
    control_points.push_back(start.reshaped(Dim, pattern_->size()));
  }
  auto counted = this->counted_samples(l, *level.grid, control_points);
  level.counted_measures = std::move(counted.measures);
  std::shared_ptr<Metric<Dim>> metric =
      channel_metric<Dim>(channels_, l, std::move(counted.weights));
  level.image_weight = parts_.image_weight * metric->unit();
  level.noise_floor = metric->noise_power()
                          ? -std::numeric_limits<double>::infinity()
                          : 1e-11 * parts_.image_weight * level.counted_measures.front();
  level.image = std::make_shared<ImageTerm<Dim>>(level.grid, std::move(metric), affine_,
                                                 this->rows_of_level(l));
}

template <int Dim>
std::unique_ptr<RegistrationObjective<Dim>> RegistrationRun<Dim>::objective(
    const Level& level) const {
  auto energies = energies_;
  for (auto& energy : energies) {
    if (energy.name == kBendingName) energy.weight *= level.bending_factor;
    if (energy.name == kElasticName) energy.weight *= std::sqrt(level.bending_factor);
  }
  return std::make_unique<RegistrationObjective<Dim>>(pattern_, level.image, level.image_weight,
                                                      std::move(energies));
}

template <int Dim>
void RegistrationRun<Dim>::optimise() {
  this->tell("start", 0, 0, 0);
  std::vector<Phi> candidates = starts();
  const Phi start = candidates.front();
  this->add_time("start");
  for (std::size_t l = 0; l < num_levels_ && !cancelled_; ++l) {
    choose_samples(l, candidates);
    candidates = {solve_level(l, candidates)};
  }
  Phi& phi = candidates.front();
  if (result_.levels.size() == num_levels_) keep_better(start, phi);
  this->add_time("optimization");
  if (parts_.schedule.require_invertible && !cancelled_) make_invertible(start, phi);
  if (parts_.look_for_finer_places && parts_.has_images() && !cancelled_) {
    look_for_finer_places(phi);
    this->add_time("finer places");
  }
  report(phi);
}

template class RegistrationRun<2>;
template class RegistrationRun<3>;

}  // namespace crease
