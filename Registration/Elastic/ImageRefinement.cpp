#include "Registration/Elastic/ImageRefinement.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "Core/Error.h"
#include "Images/IntensityRange.h"
#include "Images/Pyramid.h"
#include "Optimizers/DampedIteration.h"
#include "Optimizers/GaussNewton.h"
#include "Registration/Elastic/DisplacementSamples.h"
#include "Registration/Elastic/RefinementLevels.h"
#include "Registration/LandmarkConstraints.h"
#include "Registration/RegistrationObjective.h"
#include "Registration/SamplesInside.h"
#include "Transforms/Energies/LinearElasticEnergy.h"

namespace crease {
namespace {

constexpr int kSmallestAxis = 16;     // pixels of a level
constexpr double kRounding = 1e-11;   // of intensities, squared: no difference
constexpr double kMarginPixels = 16;  // how far u* is followed beyond its domain at least
constexpr double kMarginMm = 4;       // the same

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void check(const ImageRefinementOptions& o) {
  const bool good = o.relative_weight > 0 && (!o.weight || *o.weight > 0) && o.levels >= 1 &&
                    o.levels <= 12 && !o.smoothing_mm.empty() && o.metric != nullptr &&
                    std::ranges::all_of(o.smoothing_mm, [](double mm) { return mm >= 0; });
  if (good) return;
  throw InvalidInput(message("image refinement: need a relative weight above 0 (is ",
                             o.relative_weight,
                             "), a weight above 0 where one is given, 1 to 12 "
                             "levels (",
                             o.levels, "), a metric, and widths of the smoothing of 0 or more."));
}

double trace(const NullSpace& null_space, const Eigen::SparseMatrix<double>& matrix) {
  Eigen::SparseMatrix<double> reduced;
  null_space.reduce_hessian(matrix, reduced);
  return reduced.diagonal().sum();
}

/// One refinement, level by level.
class Refinement {
 public:
  Refinement(const Image<float, 2>& fixed, const Image<float, 2>& moving, const Mask<2>* mask,
             const SplineTransform<2>& start, const ImageRefinementOptions& options,
             const RegistrationCallback& progress)
      : fixed_(fixed),
        moving_(moving),
        mask_(mask),
        start_(start),
        basis_(start.basis()),
        options_(options),
        progress_(progress),
        elasticity_(std::make_shared<LinearElasticEnergy<2>>(basis_, options.material)) {
    check(options);
    pin();
    unit_ = intensity_unit(fixed, mask);
    if (!(unit_ > 0)) throw InvalidInput("image refinement: the fixed image is constant.");
  }

  ImageRefinementResult run() {
    Eigen::VectorXd v = Eigen::VectorXd::Zero(2 * basis_.num_control_points());
    std::vector<int> shrinks;
    for (int shrink = 1; std::ssize(shrinks) < options_.levels && fits(shrink); shrink *= 2) {
      shrinks.insert(shrinks.begin(), shrink);
    }
    num_levels_ = static_cast<int>(shrinks.size());
    for (std::size_t l = 0; l < shrinks.size() && !cancelled_; ++l) refine(l, shrinks[l], v);
    auto transform = std::make_shared<SplineTransform<2>>(start_.shared_basis());
    transform->set_parameters(v);
    result_.transform = std::move(transform);
    return std::move(result_);
  }

 private:
  bool fits(int shrink) const {
    const auto& size = fixed_.size();
    return shrink == 1 || std::min(size[0], size[1]) / shrink >= kSmallestAxis;
  }

  /// v = 0 at the pins.
  void pin() {
    Landmarks<2> pins;
    for (const Point<2>& p : options_.pins) pins.fixed.push_back(basis_.nearest_point(p));
    pins.moving = pins.fixed;
    auto constraints = make_landmark_constraints<2>(
        pins, basis_, {}, {.conflict = LandmarkConflict::kCompromise}, NullSpaceKind::kElimination);
    null_space_ = constraints.null_space;
    if (null_space_->rank() < 2) {
      throw InvalidInput(
          "image refinement: two pins at different places are needed, or the whole body can turn.");
    }
    elastic_trace_ = trace(*null_space_, elasticity_->matrix());
  }

  void refine(std::size_t l, int shrink, Eigen::VectorXd& v) {
    const auto start = Clock::now();
    RefinementLevel level;
    level.shrink = shrink;
    level.smoothing_mm = options_.smoothing_mm[std::min(l, options_.smoothing_mm.size() - 1)];
    const auto term = image_term(level);
    level.weight = options_.weight.value_or(0) * term->metric().unit();
    if (!options_.weight && !weigh(*term, level)) {
      result_.warnings.push_back(message("image refinement: the images by ", shrink,
                                         " have no structure to go by; this level is left out."));
      return;
    }
    RegistrationObjective<2> objective(basis_.pattern(), term, level.weight,
                                       {{"elastic", 1, elasticity_}});
    const double J = objective.evaluate(v, nullptr, nullptr);
    level.metric_before = objective.terms().at("image");
    level.setup_s = seconds_since(start);
    if (!term->metric().noise_power() && J <= kRounding * level.weight * measure_) {
      level.stopped_because = "the images match to rounding";
      level.metric_after = level.metric_before;
      level.elastic_energy = objective.terms().at("elastic");
    } else {
      minimise(l, objective, v, level);
    }
    result_.levels.push_back(std::move(level));
  }

  /// The metric at a level's samples, as a function of v.
  std::shared_ptr<ImageTerm<2>> image_term(RefinementLevel& level) {
    Image<float, 2> fixed = refinement_image(fixed_, level.shrink, level.smoothing_mm, unit_);
    const Raster<2> raster = fixed.raster();
    level.size = raster.size;
    const bool bound = level.shrink == 1 && options_.grid != nullptr;
    std::shared_ptr<const BoundGrid<2>> grid = bound ? options_.grid : basis_.bind(raster);
    std::shared_ptr<const Interpolator<2>> moving = make_interpolator(
        refinement_image(moving_, level.shrink, level.smoothing_mm, unit_), options_.interpolation);
    std::vector<float> weights = sample_weights(level.shrink, raster);
    keep_samples_in_domain(*grid, weights);
    keep_samples_inside<2>(*grid, start_.affine(), start_.control_points(), moving->raster(), 1,
                           weights);
    measure_ = raster.sample_volume() * static_cast<double>(std::ranges::count(weights, 1.0f));
    if (measure_ == 0) {
      throw InvalidInput(
          "image refinement: no sample of the domain is mapped into the moving image.");
    }
    const double margin = std::max(kMarginMm, kMarginPixels * raster.spacing.maxCoeff());
    DisplacementSamples samples = sample_displacement(start_, *grid, {.margin_mm = margin});
    level.displacement_error_pixels = samples.largest_error;
    MetricInput<2> input;
    input.fixed = std::move(fixed);
    input.weights = std::move(weights);
    input.moving = std::make_shared<DisplacedInterpolator<2>>(std::move(moving),
                                                              std::move(samples.components));
    return std::make_shared<ImageTerm<2>>(grid, options_.metric(std::move(input)), AffineMap<2>());
  }

  std::vector<float> sample_weights(int shrink, const Raster<2>& raster) const {
    std::vector<float> weights(static_cast<std::size_t>(raster.num_samples()), 1.0f);
    if (mask_ == nullptr) return weights;
    const Mask<2> mask = shrink_mask(*mask_, ShrinkFactors<2>{shrink, shrink});
    std::ranges::transform(mask.values(), weights.begin(),
                           [](std::uint8_t counts) { return counts ? 1.0f : 0.0f; });
    return weights;
  }

  /// alpha by traces. False where the images have no gradient.
  bool weigh(ImageTerm<2>& term, RefinementLevel& level) const {
    BlockHessian<2> data(basis_.pattern());
    const ControlPoints<2> rest = ControlPoints<2>::Zero(2, basis_.num_control_points());
    term.evaluate(rest, 1, nullptr, &data);
    const double data_trace = trace(*null_space_, data.to_sparse());
    if (!(data_trace > 0)) return false;
    level.weight = options_.relative_weight * elastic_trace_ / data_trace;
    return true;
  }

  std::unique_ptr<Optimizer> optimizer() const {
    OptimizerOptions stopping = {.relative_decrease = options_.relative_decrease,
                                 .small_decreases = 1,
                                 .relative_gradient = 0,
                                 .step_length = options_.step_pixels,
                                 .max_iterations = options_.max_iterations};
    if (options_.method == RefinementMethod::kDamped) {
      stopping.step_length *= options_.damped_step;  // of the step w that is taken in part
      return std::make_unique<DampedIteration>(
          elasticity_->matrix(), stopping, DampedIterationOptions{.step = options_.damped_step});
    }
    GaussNewtonOptions options;
    options.linear_solver.kind = LinearSolver::kPreconditionedCg;
    return std::make_unique<GaussNewton>(stopping, options);
  }

  void minimise(std::size_t l, RegistrationObjective<2>& objective, Eigen::VectorXd& v,
                RefinementLevel& level) {
    const auto start = Clock::now();
    const OptimizerResult found =
        optimizer()->minimize(objective, v, null_space_.get(),
                              [&](const IterationRecord& record) { return tell(l, record); });
    v = found.x;
    objective.evaluate(v, nullptr, nullptr);
    level.metric_after = objective.terms().at("image");
    level.elastic_energy = objective.terms().at("elastic");
    level.iterations = found.iterations;
    level.evaluations = found.num_evaluations;
    level.factorizations = found.num_factorizations;
    level.history = found.history;
    level.stopped_because = found.reason_text;
    level.iterations_s = seconds_since(start);
    if (options_.method == RefinementMethod::kDamped) note_halvings(level);
    if (found.reason == StopReason::kIterationLimit || found.reason == StopReason::kCancelled) {
      result_.converged = false;
    }
  }

  void note_halvings(RefinementLevel& level) {
    if (level.iterations == 0) return;
    const double last = level.history.back().damping;
    level.halvings = static_cast<int>(std::lround(std::log2(options_.damped_step / last)));
    if (level.halvings == 0) return;
    result_.warnings.push_back(message("image refinement: J grew with a damped step of ",
                                       options_.damped_step, "; it was lowered to ", last,
                                       " for the images by ", level.shrink, "."));
  }

  bool tell(std::size_t l, const IterationRecord& record) {
    if (!progress_) return true;
    RegistrationProgress state{.stage = "refinement",
                               .level = static_cast<int>(l) + 1,
                               .num_levels = num_levels_,
                               .iteration = record.iteration,
                               .energy = record.value};
    const double share = std::pow(0.25, num_levels_ - 1 - static_cast<int>(l));
    state.fraction = share * std::min(1.0, 0.25 + record.iteration / 8.0);
    cancelled_ = !progress_(state);
    return !cancelled_;
  }

  const Image<float, 2>& fixed_;
  const Image<float, 2>& moving_;
  const Mask<2>* mask_;
  const SplineTransform<2>& start_;
  const SplineBasis<2>& basis_;
  const ImageRefinementOptions& options_;
  const RegistrationCallback& progress_;
  std::shared_ptr<const LinearElasticEnergy<2>> elasticity_;
  std::shared_ptr<const NullSpace> null_space_;
  double elastic_trace_ = 0;
  double unit_ = 1;
  double measure_ = 0;  // mm^2 of the samples that count at this level
  int num_levels_ = 1;
  bool cancelled_ = false;
  ImageRefinementResult result_;
};

}  // namespace

ImageRefinementResult refine_by_images(const Image<float, 2>& fixed, const Image<float, 2>& moving,
                                       const Mask<2>* fixed_mask, const SplineTransform<2>& start,
                                       const ImageRefinementOptions& options,
                                       const RegistrationCallback& progress) {
  return Refinement(fixed, moving, fixed_mask, start, options, progress).run();
}

}  // namespace crease
