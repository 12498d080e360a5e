#include "Registration/TransformRun.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "Core/Error.h"
#include "Optimizers/GaussNewton.h"
#include "Registration/DeterminedParameters.h"

namespace crease {
namespace {

/// A cost with other weights.
template <int Dim>
class Reweighted final : public ObjectiveFunction {
 public:
  using Weights = typename TransformObjective<Dim>::Weights;
  Reweighted(TransformObjective<Dim>& cost, const Weights& weights)
      : cost_(cost), weights_(weights) {}
  Eigen::Index size() const override { return cost_.size(); }
  double evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient,
                  Eigen::SparseMatrix<double>* hessian) override {
    const Weights before = cost_.weights();
    cost_.set_weights(weights_);
    const double value = cost_.evaluate(x, gradient, hessian);
    cost_.set_weights(before);
    return value;
  }

 private:
  TransformObjective<Dim>& cost_;
  Weights weights_;
};

constexpr double kSpansPerDetail = 4;  // of the lattice

}  // namespace

template <int Dim>
RegistrationResult<Dim> TransformRun<Dim>::execute() {
  check_parts();
  if (parts_.has_images()) this->normalise_images();
  this->find_initial_map();
  this->add_time("alignment");
  make_transform();
  make_constraints();
  this->add_time("constraints");
  if (parts_.has_images()) {
    this->make_channel_levels();
    const double span = parts_.transform_options.detail_mm / kSpansPerDetail;
    for (const auto& image : channels_.front().levels) {
      const Raster<Dim>& raster = image.fixed.raster();
      lattices_.push_back(std::make_shared<TransformLattice<Dim>>(
          raster, std::max(span, raster.spacing.minCoeff())));
    }
  }
  this->add_time("binding");
  this->tell("start", 0, 0, 0);
  const Eigen::VectorXd rest = transform_->parameters();
  Eigen::VectorXd parameters = null_space_->expand(null_space_->coordinates(rest));
  const Eigen::VectorXd start = parameters;
  for (std::size_t l = 0; l < num_levels_ && !cancelled_; ++l) {
    parameters = solve_level(l, parameters);
  }
  // Coarse levels may lead astray: no result is worse than the start.
  const auto finest = objective(num_levels_ - 1, parameters);
  const double at_start = finest->evaluate(start, nullptr, nullptr);
  const double found = finest->evaluate(parameters, nullptr, nullptr);
  if (found > at_start + 1e-6 * std::abs(at_start)) {
    parameters = start;
    result_.stopped_because = "no better map than the start was found";
  }
  this->add_time("optimization");
  report(*finest, parameters);
  return std::move(result_);
}

template <int Dim>
void TransformRun<Dim>::check_parts() const {
  const bool soft = !soft_landmarks(parts_.landmarks, parts_.landmark_options).fixed.empty();
  if (!parts_.has_images() && !(parts_.transform_options.roughness > 0) && !soft) {
    throw InvalidInput(
        "registration: nothing to minimise; give images, a weight of roughness or soft landmarks");
  }
  if (!parts_.further.empty()) {
    throw InvalidInput("registration: several channels at once need a spline basis");
  }
  if (!parts_.energies.empty()) {
    throw InvalidInput(message("registration: the ", parts_.energies.front().name,
                               " energy needs a spline basis; a transform has its own roughness"));
  }
}

template <int Dim>
void TransformRun<Dim>::make_transform() {
  transform_ = parts_.transform(affine_);
  if (transform_ == nullptr) throw InvalidInput("registration: the factory made no transform");
}

template <int Dim>
void TransformRun<Dim>::make_constraints() {
  auto constraints =
      make_landmark_constraints(parts_.landmarks, *transform_, parts_.transform_options.detail_mm,
                                parts_.landmark_options, parts_.null_space);
  null_space_ = constraints.null_space;
  for (const auto& note : constraints.notes) result_.warnings.push_back(note);
  result_.free_parameters = null_space_->reduced_size();
  soft_landmarks_ = soft_landmarks(parts_.landmarks, parts_.landmark_options);
  const auto& options = parts_.transform_options;
  if (options.roughness > 0) weights_.push_back({"bending", options.roughness, nullptr});
  if (!soft_landmarks_.fixed.empty()) {
    weights_.push_back({"landmarks", parts_.landmark_options.weight, nullptr});
  }
  if (parts_.schedule.adapt_weights && parts_.has_images() && options.roughness > 0) {
    // The range of weights goes with the square of this, as that of bending with the edges'.
    adapted_.emplace(parts_.landmark_options.weight, std::pow(options.detail_mm, 0.5 * (Dim + 1)));
  }
  solver_ = std::make_shared<DampedSolver>(LinearSolverOptions{.kind = LinearSolver::kDirect}, 1);
}

template <int Dim>
double TransformRun<Dim>::weight_of(const std::string& name) const {
  const auto found = std::ranges::find(weights_, name, &WeightedEnergy<Dim>::name);
  return found == weights_.end() ? 0 : found->weight;
}

template <int Dim>
void TransformRun<Dim>::set_weights(std::size_t l, Objective& cost) const {
  const double coarser = std::pow(parts_.schedule.level_bending, num_levels_ - 1 - l);
  const double image = cost.metric() == nullptr ? 0 : parts_.image_weight * cost.metric()->unit();
  cost.set_weights({.image = image,
                    .roughness = weight_of("bending") * coarser,
                    .landmarks = weight_of("landmarks")});
}

/// @param start  samples that it maps outside the moving image do not count at this level.
template <int Dim>
std::unique_ptr<TransformObjective<Dim>> TransformRun<Dim>::objective(
    std::size_t l, const Eigen::VectorXd& start) {
  auto transform = transform_->clone();
  transform->set_parameters(start);
  std::shared_ptr<const TransformLattice<Dim>> lattice;
  std::shared_ptr<Metric<Dim>> metric;
  if (parts_.has_images()) {
    lattice = lattices_[l];
    auto counted =
        this->counted_samples(l, *lattice->grid(), {lattice->control_points(*transform, affine_)});
    counted_measure_ = counted.measures.front();
    metric = channel_metric<Dim>(channels_, l, std::move(counted.weights));
  }
  auto cost = std::make_unique<Objective>(
      std::move(transform), std::move(lattice), std::move(metric), affine_,
      parts_.transform_options.detail_mm, typename Objective::Weights{}, soft_landmarks_);
  set_weights(l, *cost);
  return cost;
}

template <int Dim>
typename TransformRun<Dim>::Round TransformRun<Dim>::minimise(std::size_t l, Objective& cost,
                                                              const Eigen::VectorXd& start) {
  const bool finest = l + 1 == num_levels_;
  const bool last =
      finest && (!adapted_ || adapted_->num_balancings() >= static_cast<int>(num_levels_));
  const bool in_units_of_noise = cost.metric() != nullptr && cost.metric()->noise_power();
  GaussNewtonOptions options;
  options.solver = solver_;
  // Without images the cost of a linear transform is quadratic: one whole step.
  if (!parts_.has_images()) options.initial_damping = 1e-10;
  const auto optimizer =
      this->optimizer(this->stopping_rule(finest, last, in_units_of_noise, 100), options);
  Round round;
  static_cast<OptimizerResult&>(round) =
      optimizer->minimize(cost, start, null_space_.get(), [&](const IterationRecord& record) {
        this->tell("level", l, record.iteration, record.value);
        return !cancelled_;
      });
  return round;
}

/// Minimises on a level, anew as long as its weights change.
template <int Dim>
Eigen::VectorXd TransformRun<Dim>::solve_level(std::size_t l, const Eigen::VectorXd& start) {
  const auto cost = objective(l, start);
  LevelReport level;
  level.shrink = channels_.empty() ? 1 : channels_.front().levels[l].shrink;
  cost->evaluate(start, nullptr, nullptr);
  level.terms_before = cost->terms();
  Round round = minimise(l, *cost, start);
  while (true) {
    this->book(round, level);
    this->warn_of_limit(l, round);
    cost->evaluate(round.x, nullptr, nullptr);
    level.terms_after = cost->terms();
    if (cancelled_ || !renew_weights(l, *cost, level, round.x)) break;
    round = minimise(l, *cost, round.x);
  }
  result_.levels.push_back(std::move(level));
  return std::move(round.x);
}

/// Whether the level is worth another minimisation, with other weights.
template <int Dim>
bool TransformRun<Dim>::renew_weights(std::size_t l, Objective& cost, const LevelReport& report,
                                      const Eigen::VectorXd& parameters) {
  const auto roughness = report.terms_after.find("roughness");
  if (!adapted_ || roughness == report.terms_after.end()) return false;
  Reweighted<Dim> image(cost, {.image = cost.weights().image, .roughness = 0, .landmarks = 0});
  const Metric<Dim>& metric = *cost.metric();
  const BendingBalance found{.image_energy = metric.unit() * report.terms_after.at("image"),
                             .noise_power = metric.noise_power(),
                             .counted_measure = counted_measure_,
                             .correlated_measure = this->correlated_measure(l),
                             .bending_energy = roughness->second,
                             .determined_parameters = determined_parameters(
                                 image, cost, parameters, *null_space_, *solver_)};
  const bool again = adapted_->balance(found, l + 1 == num_levels_, weights_);
  set_weights(l, cost);
  return again;
}

template <int Dim>
void TransformRun<Dim>::report(Objective& finest, const Eigen::VectorXd& parameters) {
  if (parts_.has_images()) {
    const Eigen::VectorXd rest = transform_->parameters();
    this->report_images(finest.shared_metric(), [&](int end) {
      finest.evaluate(end == 0 ? rest : parameters, nullptr, nullptr);
      return finest.terms().at("image");
    });
  }
  result_.cost = finest.evaluate(parameters, nullptr, nullptr);
  result_.energies = finest.terms();
  for (const auto& [name, weight, energy] : weights_) {
    result_.weights[name == "bending" ? "roughness" : name] = weight;
  }
  transform_->set_parameters(parameters);
  this->report_landmarks(*transform_);
  result_.transform = std::move(transform_);
  this->add_time("report");
}

template class TransformRun<2>;
template class TransformRun<3>;

}  // namespace crease
