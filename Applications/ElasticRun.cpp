#include "Applications/ElasticRun.h"

#include "Applications/MetricChoice.h"
#include "Core/Error.h"
#include "Registration/Elastic/PairPlaces.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/CompositeTransform.h"

namespace crease {
namespace {

/// How far outside the mesh a pair along the skin may lie, mm: it is moved onto the border without a word.
constexpr double kContourSnap = 1.5;

ElasticDomainOptions domain_options(const ElasticCommandOptions& o) {
  ElasticDomainOptions options;
  options.degree = o.degree;
  options.creases = !o.no_creases;
  if (o.mesh_size) {
    options.edge_length = *o.mesh_size;
    options.num_triangles = 0;
  } else if (o.triangles) {
    options.num_triangles = *o.triangles;
  }
  return options;
}

ElasticRegistrationOptions registration_options(const ElasticCommandOptions& o) {
  ElasticRegistrationOptions options;
  if (o.steps == "adaptive") {
    options.load.schedule = LoadSchedule::kAdaptive;
  } else {
    options.load.steps = o.num_steps();
  }
  if (o.corrector == "none") options.load.corrector = LoadCorrector::kNone;
  if (o.quadrature == "cheap") options.quadrature = ElasticQuadrature::kCheap;
  options.refine = !o.no_refine;
  options.pin_contour = o.pin == "contour";
  ImageRefinementOptions& refinement = options.refinement;
  refinement.metric = metric_named<2>(o.metric);
  if (o.alpha_relative) refinement.relative_weight = *o.alpha_relative;
  refinement.weight = o.alpha;
  refinement.levels = o.levels;
  refinement.smoothing_mm = o.smoothing;
  if (o.refinement == "damped") refinement.method = RefinementMethod::kDamped;
  refinement.damped_step = o.damped_step;
  return options;
}

/// Where nobody asked for a law, and no pairs that must be met were given.
bool may_choose_law(const ElasticCommandOptions& options) {
  return !options.material.law && options.pairs.empty();
}

/// The transform as the moving image is given.
std::shared_ptr<const Transform<2>> given_transform(const ElasticInput& input,
                                                    const ElasticRegistrationResult& found) {
  if (!input.mirrored) return found.transform;
  std::vector<std::unique_ptr<Transform<2>>> parts;
  if (found.refinement) parts.push_back(found.refinement->transform->clone());
  parts.push_back(found.deformation->clone());
  parts.push_back(std::make_unique<AffineTransform<2>>(input.to_given));
  return std::make_shared<CompositeTransform<2>>(std::move(parts));
}

}  // namespace

ElasticOutcome run_elastic(const ElasticCommandOptions& options, const ElasticInput& input,
                           RunReport& report, ProgressReporter& progress) {
  progress.report({.stage = "domain"});
  ElasticBody body = input.body(options.material);
  ElasticOutcome outcome;
  outcome.material = body.material;
  outcome.domain = make_elastic_domain(body, domain_options(options));
  report.add_warnings(outcome.domain.warnings);
  outcome.pairs = input.pairs;
  place_on_border(outcome.pairs, input.contour, *outcome.domain.basis, kContourSnap);
  report.add_warnings(
      strange_pairs(outcome.pairs, outcome.domain.basis->bounds().size().minCoeff()));
  report.end_stage("domain");
  const auto run = [&] {
    outcome.registration = register_elastically(input.fixed.image, input.moving.image, nullptr,
                                                body, outcome.domain, outcome.pairs, input.contour,
                                                registration_options(options), progress.callback());
    for (const auto& [stage, seconds] : outcome.registration.timings_s) {
      report.add_part(stage, seconds);
    }
  };
  run();
  if (outcome.registration.load.fraction < 1 && may_choose_law(options)) {
    report.add_warning(
        message("St. Venant-Kirchhoff tissue cannot follow the pairs found in the images beyond "
                "load fraction ",
                outcome.registration.load.fraction,
                "; neo-Hookean tissue, which cannot be turned inside out, was taken instead "
                "(--material)."));
    outcome.material.law = body.material.law = ElasticLaw::kNeoHookean;
    run();
  }
  report.add_warnings(outcome.registration.warnings);
  outcome.transform = given_transform(input, outcome.registration);
  report.end_stage("registration");
  return outcome;
}

}  // namespace crease
