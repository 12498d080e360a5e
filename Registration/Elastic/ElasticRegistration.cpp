#include "Registration/Elastic/ElasticRegistration.h"

#include <chrono>
#include <cmath>

#include "Core/Error.h"
#include "Registration/Elastic/BodyOutline.h"
#include "Registration/Elastic/ImageImprovement.h"
#include "Transforms/CompositeTransform.h"

namespace crease {
namespace {

/// Of a run of the first step, by share of the load; it takes about a third of the time.
constexpr double kLoadShare = 0.3;

constexpr double kShortestEdge = 1.0 / 3;  // of the outline, of the mesh's edges
constexpr double kShortEdgeTolerance = 3;  // times that of the outline

/// About that of the mesh: of equilateral triangles that fill the region.
double edge_length(const RegionOfInterest& region, const ElasticDomainOptions& options) {
  if (options.num_triangles == 0) {
    return options.edge_length > 0 ? options.edge_length : default_edge_length(region.bounds());
  }
  return std::sqrt(4 / std::sqrt(3.0) * region.area() / options.num_triangles);
}

/// One registration, stage by stage.
class ElasticRun {
 public:
  ElasticRun(const Image<float, 2>& fixed, const Image<float, 2>& moving, const Mask<2>* mask,
             const ElasticBody& body, const CreasedDomain& domain,
             const ElasticRegistrationOptions& options, const RegistrationCallback& progress)
      : fixed_(fixed),
        moving_(moving),
        mask_(mask),
        body_(body),
        domain_(domain),
        options_(options),
        progress_(progress) {}

  ElasticRegistrationResult execute(const Landmarks<2>& pairs, const std::vector<int>& contour) {
    deform_by(pairs, contour);
    const std::shared_ptr<const BoundGrid<2>> grid = domain_.basis->bind(fixed_.raster());
    add_time("binding");
    measure(grid, result_.improvement_by_pairs);
    result_.transform = result_.deformation;
    if (!options_.refine || !result_.failure.empty() || cancelled_) return std::move(result_);
    try {
      refine(pairs, contour, grid);
    } catch (const SolverError& error) {
      result_.failure = message(error.what(), " The result is what the pairs do, not refined.");
      return std::move(result_);
    }
    add_time("refinement");
    measure(grid, result_.improvement_by_images);
    return std::move(result_);
  }

 private:
  void deform_by(const Landmarks<2>& pairs, const std::vector<int>& contour) {
    const ElasticDeformation deformation{.basis = domain_.basis,
                                         .material = body_.material,
                                         .pairs = pairs,
                                         .contour = contour,
                                         .quadrature = options_.quadrature};
    try {
      result_.load =
          deform_elastically(deformation, options_.load, [&](const LoadStepRecord& record) {
            return tell({.stage = "load steps",
                         .iteration = record.step,
                         .energy = record.fraction,
                         .fraction = kLoadShare * record.fraction});
          });
      if (cancelled_) result_.failure = "cancelled";
    } catch (const NoEquilibrium& error) {
      result_.load = error.last_state();
      result_.failure =
          message(error.what(), " The result is the last equilibrium on the way, not refined.");
    }
    result_.factorizations = result_.load.factorizations;
    result_.deformation =
        std::make_shared<SplineTransform<2>>(transform_of(deformation, result_.load));
    result_.warnings = result_.load.warnings;
    add_time("load steps");
  }

  /// The images are not kept in memory meanwhile.
  void measure(const std::shared_ptr<const BoundGrid<2>>& grid, std::optional<double>& percent) {
    const ImageImprovement improvement(fixed_, moving_, mask_, grid);
    result_.images_equal = improvement.equal();
    percent = improvement.percent(
        *result_.deformation, result_.refinement ? result_.refinement->transform.get() : nullptr);
    add_time("improvement");
  }

  void refine(const Landmarks<2>& pairs, const std::vector<int>& contour,
              const std::shared_ptr<const BoundGrid<2>>& grid) {
    ImageRefinementOptions refinement = options_.refinement;
    refinement.material = body_.material;
    refinement.grid = grid;
    refinement.pins = chest_wall_ends(body_.region);
    if (options_.pin_contour) {
      for (int i : contour) refinement.pins.push_back(pairs.fixed[static_cast<std::size_t>(i)]);
    }
    result_.refinement = refine_by_images(
        fixed_, moving_, mask_, *result_.deformation, refinement, [&](RegistrationProgress state) {
          state.fraction = kLoadShare + (1 - kLoadShare) * 0.8 * state.fraction;
          return tell(state);
        });
    for (const auto& level : result_.refinement->levels) {
      result_.factorizations += level.factorizations;
    }
    result_.warnings.insert(result_.warnings.end(), result_.refinement->warnings.begin(),
                            result_.refinement->warnings.end());
    std::vector<std::unique_ptr<Transform<2>>> parts;
    parts.push_back(result_.refinement->transform->clone());
    parts.push_back(result_.deformation->clone());
    result_.transform = std::make_shared<CompositeTransform<2>>(std::move(parts));
  }

  bool tell(const RegistrationProgress& state) {
    cancelled_ = progress_ && !progress_(state);
    return !cancelled_;
  }

  void add_time(const std::string& stage) {
    const auto now = std::chrono::steady_clock::now();
    result_.timings_s[stage] += std::chrono::duration<double>(now - last_time_).count();
    last_time_ = now;
  }

  const Image<float, 2>& fixed_;
  const Image<float, 2>& moving_;
  const Mask<2>* mask_;
  const ElasticBody& body_;
  const CreasedDomain& domain_;
  const ElasticRegistrationOptions& options_;
  const RegistrationCallback& progress_;
  bool cancelled_ = false;
  std::chrono::steady_clock::time_point last_time_ = std::chrono::steady_clock::now();
  ElasticRegistrationResult result_;
};

}  // namespace

CreasedDomain make_elastic_domain(const ElasticBody& body, const ElasticDomainOptions& options) {
  const double tolerance = options.outline_tolerance;
  const double shortest = kShortestEdge * edge_length(body.region, options);
  std::vector<Polyline> rings;
  for (const Polyline& ring : body.region.rings()) {
    rings.push_back(without_short_edges(simplify_polyline(ring, true, tolerance), shortest,
                                        kShortEdgeTolerance * tolerance));
  }
  const RegionOfInterest region(std::move(rings));
  std::vector<FeatureLine> lines = body.lines;
  for (FeatureLine& line : lines) {
    if (!line.edge_kinds.empty()) continue;
    line.points = simplify_polyline(line.points, line.closed, tolerance);
  }
  const CreasedDomainOptions wanted = {.degree = options.degree,
                                       .creases = options.creases,
                                       .edge_length = options.edge_length,
                                       .num_triangles = options.num_triangles,
                                       .rigid_bodies = false};
  return body.labels != nullptr ? make_creased_domain(region, *body.labels, lines, wanted)
                                : make_creased_domain(region, lines, wanted);
}

ElasticRegistrationResult register_elastically(const Image<float, 2>& fixed,
                                               const Image<float, 2>& moving, const Mask<2>* mask,
                                               const ElasticBody& body, const CreasedDomain& domain,
                                               const Landmarks<2>& pairs,
                                               const std::vector<int>& contour,
                                               const ElasticRegistrationOptions& options,
                                               const RegistrationCallback& progress) {
  return ElasticRun(fixed, moving, mask, body, domain, options, progress).execute(pairs, contour);
}

}  // namespace crease
