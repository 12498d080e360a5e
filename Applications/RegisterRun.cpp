#include "Applications/RegisterRun.h"

#include <algorithm>
#include <cmath>

#include "Applications/MetricChoice.h"
#include "Applications/RegisterBasis.h"
#include "Images/IntensityRange.h"
#include "Images/Moments.h"
#include "Registration/Elastic/ElasticRegularization.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/LandmarkFits.h"
#include "Transforms/RigidTransform.h"
#include "Transforms/SimilarityTransform.h"

namespace crease {
namespace {

template <typename Image>
const Image* pointer(const std::optional<Image>& image) {
  return image ? &*image : nullptr;
}

AlignmentSearch search_of(const std::string& name) {
  if (name == "rigid") return AlignmentSearch::kRigid;
  if (name == "similarity") return AlignmentSearch::kSimilarity;
  return name == "affine" ? AlignmentSearch::kAffine : AlignmentSearch::kNone;
}

OptimizerKind optimizer_of(const std::string& name) {
  if (name == "lbfgs") return OptimizerKind::kLbfgs;
  if (name == "conjugate-gradient") return OptimizerKind::kConjugateGradient;
  if (name == "steepest-descent") return OptimizerKind::kSteepestDescent;
  return name == "nelder-mead" ? OptimizerKind::kNelderMead : OptimizerKind::kGaussNewton;
}

/// How A is found: what was asked for; without --init by landmarks where there are enough.
template <int Dim>
AlignmentOptions alignment_options(const RegisterOptions& options, int num_landmarks) {
  AlignmentOptions alignment;
  alignment.search =
      search_of(options.is_linear() ? options.transform : options.init_transform.value_or("none"));
  const int needed = alignment.search == AlignmentSearch::kAffine ? Dim + 1 : Dim;
  const std::string start =
      options.init.value_or(num_landmarks >= needed ? "landmarks" : "moments");
  if (start == "landmarks") alignment.start = AlignmentStart::kLandmarks;
  if (start == "centres") alignment.start = AlignmentStart::kCentres;
  if (start == "identity") alignment.start = AlignmentStart::kIdentity;
  if (!options.has_metric()) alignment.search = AlignmentSearch::kNone;
  alignment.optimizer = optimizer_of(options.optimizer);
  return alignment;
}

/// What is compared; masks are the first's.
template <int Dim>
std::vector<ChannelView<Dim>> channels_of(const RegisterOptions& options,
                                          const RegisterInput<Dim>& input) {
  std::vector<ChannelView<Dim>> channels;
  for (std::size_t c = 0; c < options.num_channels(); ++c) {
    ChannelView<Dim> channel;
    channel.fixed = c == 0 ? &input.fixed.image : &input.further_fixed[c - 1].image;
    channel.moving = c == 0 ? &input.moving.image : &input.further_moving[c - 1].image;
    channel.fixed_mask = pointer(input.fixed_mask);
    if (c == 0) channel.moving_mask = pointer(input.moving_mask);
    channel.metric = metric_named<Dim>(options.metric_of(c));
    channel.weight = options.weight_of(c);
    channels.push_back(std::move(channel));
  }
  return channels;
}

/// A, found or given.
template <int Dim>
Alignment<Dim> find_start(const RegisterOptions& options, const RegisterInput<Dim>& input,
                          RunReport& report, ProgressReporter& progress) {
  progress.report({.stage = "alignment"});
  if (input.start && !options.has_metric()) return {.map = *input.start, .report = {}};
  const AlignmentOptions wanted = alignment_options<Dim>(options, input.landmarks.size());
  if (!options.has_metric() && wanted.start == AlignmentStart::kLandmarks) {
    if (options.transform == "similarity") {
      return {fit_similarity<Dim>(input.landmarks.fixed, input.landmarks.moving).affine_map(), {}};
    }
    if (options.transform == "affine") {
      return {fit_affine<Dim>(input.landmarks.fixed, input.landmarks.moving).affine_map(), {}};
    }
    return {fit_rigid<Dim>(input.landmarks.fixed, input.landmarks.moving).affine_map(), {}};
  }
  auto found = align<Dim>(channels_of(options, input), input.landmarks, wanted, progress.callback(),
                          input.start);
  if (!found.report.improved) {
    report.add_warning("the initial alignment found no better map than its start, which was kept.");
  }
  return found;
}

template <int Dim>
RegisterOutcome<Dim> affine_outcome(const RegisterOptions& options, const RegisterInput<Dim>& input,
                                    const Alignment<Dim>& alignment) {
  RegisterOutcome<Dim> outcome;
  const Point<Dim> centre = geometric_centre(input.fixed.image.raster());
  if (options.transform == "rigid") {
    outcome.transform = std::make_shared<RigidTransform<Dim>>(alignment.map, centre);
  } else if (options.transform == "similarity") {
    outcome.transform = std::make_shared<SimilarityTransform<Dim>>(alignment.map, centre);
  } else {
    outcome.transform = std::make_shared<AffineTransform<Dim>>(alignment.map, centre);
  }
  const AlignmentReport& found = alignment.report;
  const double unit = intensity_unit(input.fixed.image, pointer(input.fixed_mask));
  // Squares are of normalised intensities, as those of several channels are; other metrics do not mind.
  const bool raw = options.num_channels() == 1 && options.metric.front() == "ssd";
  const double scale = raw && unit > 0 ? 1 / (unit * unit) : 1;
  outcome.alignment = alignment;
  outcome.metric_before = scale * found.metric_before;
  outcome.metric_after = scale * found.metric_after;
  outcome.channels = found.channels;
  for (ChannelReport& channel : outcome.channels) {
    channel.before *= scale;
    channel.after *= scale;
  }
  outcome.energies["image"] = outcome.metric_after;
  outcome.weights["image"] = options.image_weight();
  LevelReport level;
  level.iterations = found.evaluations;
  outcome.levels.push_back(level);
  outcome.stopped_because = options.has_metric() ? "the search ended" : "fitted to the landmarks";
  outcome.free_parameters = outcome.transform->num_parameters();
  outcome.improved = !options.has_metric() || found.metric_after < found.metric_before;
  return outcome;
}

NullSpaceKind null_space_of(const std::string& name) {
  if (name == "qr") return NullSpaceKind::kQr;
  return name == "svd" ? NullSpaceKind::kSvd : NullSpaceKind::kElimination;
}

LandmarkOptions landmark_options(const RegisterOptions& options) {
  LandmarkOptions landmarks;
  if (options.landmarks_mode == "soft") landmarks.mode = LandmarkMode::kSoft;
  if (options.landmarks_conflict == "compromise") {
    landmarks.conflict = LandmarkConflict::kCompromise;
  }
  landmarks.sigma_mm = options.landmarks_sigma.value_or(landmarks.sigma_mm);
  return landmarks;
}

template <int Dim>
void add_images(const RegisterOptions& options, const RegisterInput<Dim>& input,
                Registration<Dim>& registration) {
  if (input.fixed_mask) registration.fixed_mask(*input.fixed_mask);
  if (input.moving_mask) registration.moving_mask(*input.moving_mask);
  const auto channels = channels_of(options, input);
  registration.metric(channels[0].metric, channels[0].weight).image_weight(options.alpha);
  for (std::size_t c = 1; c < channels.size(); ++c) {
    const ChannelView<Dim>& further = channels[c];
    registration.channel({*further.fixed, *further.moving, further.metric, further.weight});
  }
}

template <int Dim>
void add_spline(const RegisterOptions& options, const RegisterBasis<Dim>& basis,
                Registration<Dim>& registration, std::map<std::string, double>& weights) {
  registration.basis(basis.basis);
  const bool rigid = basis.bodies && options.rigidity_weight() > 0;
  if (options.has_elastic_energy()) {
    weights["elastic"] = options.gamma.value_or(kDefaultElasticWeight);
    if (weights["elastic"] > 0) {
      registration.energy("elastic", weights["elastic"],
                          elastic<Dim>(material_of(options.material), basis.region_at));
    }
  } else {
    weights["bending"] = options.gamma.value_or(default_bending_weight(*basis.basis));
    if (weights["bending"] > 0) {
      registration.energy("bending", weights["bending"],
                          bending<Dim>(rigid ? basis.bodies : nullptr));
    }
  }
  if (rigid) {
    weights["rigidity"] = options.rigidity_weight();
    registration.energy("rigidity", weights["rigidity"], rigidity<Dim>(basis.bodies));
  }
}

template <int Dim>
void add_cauchy_navier(const RegisterOptions& options, const RegisterInput<Dim>& input,
                       Registration<Dim>& registration, std::map<std::string, double>& weights) {
  const Raster<Dim>& raster = input.fixed.image.raster();
  const double length = options.mesh_size.value_or(default_edge_length<Dim>(raster.bounds()));
  weights["roughness"] = options.gamma.value_or(default_roughness_weight<Dim>(length));
  registration.transform(cauchy_navier<Dim>(raster, length, input.landmarks.fixed),
                         {.detail_mm = length, .roughness = weights["roughness"]});
}

template <int Dim>
Registration<Dim> compose(const RegisterOptions& options, const RegisterInput<Dim>& input,
                          const AffineMap<Dim>& start, const RegisterBasis<Dim>& basis,
                          std::map<std::string, double>& weights) {
  Registration<Dim> registration = options.has_metric()
                                       ? Registration<Dim>(input.fixed.image, input.moving.image)
                                       : Registration<Dim>();
  registration.initial(start);
  if (options.has_metric()) {
    add_images(options, input, registration);
    weights["image"] = options.alpha;
  }
  registration.interpolation(options.interpolator == "linear" ? InterpolationKind::kLinear
                                                              : InterpolationKind::kCubic);
  if (options.has_basis()) {
    add_spline(options, basis, registration, weights);
  } else {
    add_cauchy_navier(options, input, registration, weights);
  }
  if (!input.landmarks.empty()) {
    registration.landmarks(input.landmarks, landmark_options(options));
  }
  registration.optimizer(optimizer_of(options.optimizer));
  registration.null_space(null_space_of(options.null_space));
  Schedule schedule;
  schedule.levels = options.levels;
  schedule.adapt_weights = !options.gamma;
  schedule.require_invertible = options.require_invertible;
  schedule.sample_fraction = options.sample_fraction;
  schedule.seed = static_cast<std::uint64_t>(options.run.seed);
  registration.schedule(schedule);
  return registration;
}

/// Divides patches where the images ask for it; basis becomes the last one that was kept.
AdaptiveResult<2> run_adaptively(const RegisterOptions& options, const RegisterInput<2>& input,
                                 const AffineMap<2>& start, RegisterBasis<2>& basis,
                                 std::map<std::string, double>& weights, RunReport& report,
                                 ProgressReporter& progress) {
  std::vector<RegisterBasis<2>> made = {basis};
  const auto of = [&](const SplineBasis<2>* wanted) -> RegisterBasis<2>& {
    return *std::ranges::find_if(made, [&](const auto& b) { return b.basis.get() == wanted; });
  };
  AdaptiveComposition<2> parts;
  parts.make_basis = [&](const std::vector<FinerPlace<2>>& finer) {
    if (!finer.empty()) made.push_back(make_register_basis(options, input, report, finer));
    return made.back().basis;
  };
  parts.compose = [&](const std::shared_ptr<const SplineBasis<2>>& wanted) {
    return compose(options, input, start, of(wanted.get()), weights);
  };
  parts.most_rounds = options.adapt;
  AdaptiveResult<2> result = register_adaptively(parts, progress.callback());
  basis = of(&result.registration.spline()->basis());
  return result;
}

template <int Dim>
RegistrationResult<Dim> run_nonrigid(const RegisterOptions& options,
                                     const RegisterInput<Dim>& input, const AffineMap<Dim>& start,
                                     RegisterBasis<Dim>& basis, RegisterOutcome<Dim>& outcome,
                                     RunReport& report, ProgressReporter& progress) {
  if constexpr (Dim == 2) {
    if (options.adapt > 0) {
      AdaptiveResult<2> adapted =
          run_adaptively(options, input, start, basis, outcome.weights, report, progress);
      outcome.refinement = std::move(adapted.rounds);
      return std::move(adapted.registration);
    }
  }
  return compose(options, input, start, basis, outcome.weights).run(progress.callback());
}

template <int Dim>
RegisterOutcome<Dim> nonrigid_outcome(const RegisterOptions& options,
                                      const RegisterInput<Dim>& input,
                                      const Alignment<Dim>& alignment, RunReport& report,
                                      ProgressReporter& progress) {
  progress.report({.stage = "domain", .fraction = 0.05});
  RegisterBasis<Dim> basis;
  if (options.has_basis()) basis = make_register_basis(options, input, report);
  report.end_stage("domain");
  RegisterOutcome<Dim> outcome;
  outcome.alignment = alignment;
  try {
    RegistrationResult<Dim> result =
        run_nonrigid(options, input, alignment.map, basis, outcome, report, progress);
    for (const auto& [stage, seconds] : result.timings_s) report.add_part(stage, seconds);
    report.add_warnings(result.warnings);
    outcome.transform = result.transform;
    outcome.metric_before = result.metric_before;
    outcome.metric_after = result.metric_after;
    outcome.channels = result.channels;
    outcome.energies = result.energies;
    for (const auto& [name, weight] : result.weights) outcome.weights[name] = weight;
    outcome.levels = std::move(result.levels);
    outcome.unfolding = result.unfolding;
    outcome.stopped_because = result.stopped_because;
    outcome.free_parameters = result.free_parameters;
    outcome.converged = result.converged;
    outcome.improved = result.improved;
  } catch (const SolverError& error) {
    outcome.failure = message("no solution: ", error.what(), " The result is the initial map.");
    if (basis.basis != nullptr) {
      report.add_warnings(make_landmark_constraints(input.landmarks, *basis.basis, alignment.map,
                                                    landmark_options(options),
                                                    NullSpaceKind::kElimination)
                              .notes);  // what may have led there
      outcome.transform = std::make_shared<SplineTransform<Dim>>(basis.basis, alignment.map);
    } else {
      outcome.transform = std::make_shared<AffineTransform<Dim>>(alignment.map);
    }
    outcome.stopped_because = "the solver failed";
    outcome.converged = outcome.improved = false;
  }
  report.end_stage("registration");
  if (basis.basis != nullptr) {
    outcome.control_points = basis.basis->num_control_points();
    outcome.domain_measure = basis.basis->measure();
  }
  outcome.domain = std::move(basis.domain);
  return outcome;
}

}  // namespace

template <int Dim>
RegisterOutcome<Dim> run_registration(const RegisterOptions& options,
                                      const RegisterInput<Dim>& input, RunReport& report,
                                      ProgressReporter& progress) {
  const Alignment<Dim> start = find_start(options, input, report, progress);
  report.end_stage("alignment");
  if (options.is_linear()) return affine_outcome(options, input, start);
  return nonrigid_outcome(options, input, start, report, progress);
}

template RegisterOutcome<2> run_registration<2>(const RegisterOptions&, const RegisterInput<2>&,
                                                RunReport&, ProgressReporter&);
template RegisterOutcome<3> run_registration<3>(const RegisterOptions&, const RegisterInput<3>&,
                                                RunReport&, ProgressReporter&);

}  // namespace crease
