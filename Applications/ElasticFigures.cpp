#include "Applications/ElasticFigures.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "Applications/CertificateReport.h"
#include "Applications/EvaluationReport.h"
#include "Applications/LandmarkErrors.h"

namespace crease {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kSquareCentimetre = 100;  // mm^2

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json breast_json(const ElasticInput& input) {
  Json json = {{"fixed_area_cm2", input.region.area() / kSquareCentimetre},
               {"moving_area_cm2", nullptr},
               {"mirrored", input.mirrored},
               {"pectoral_muscle", input.has_muscle()}};
  if (input.moving_region) {
    json["moving_area_cm2"] = input.moving_region->area() / kSquareCentimetre;
  }
  return json;
}

Json pairs_json(const ElasticStory& story) {
  const Landmarks<2>& pairs = story.outcome.pairs;
  const auto errors = [&](const Transform<2>& transform) {
    const LandmarkErrors found = landmark_errors(pairs, transform);
    return Json{{"max_error_mm", found.largest}, {"rms_error_mm", found.rms}};
  };
  const auto& registration = story.outcome.registration;
  Json json = {{"count", pairs.size()},
               {"given", story.input.num_given_pairs()},
               {"contour", story.input.num_contour_pairs()},
               {"pectoral", story.input.num_pectoral_pairs},
               {"nipple", story.input.nipple_used},
               {"after_pairs", errors(*registration.deformation)}};
  json["after_refinement"] = registration.refinement ? errors(*registration.transform) : Json();
  return json;
}

Json material_json(const ElasticStory& story) {
  const ElasticMaterial& material = story.outcome.material;
  const auto tissue = [](const ElasticTissue& t) {
    return Json{{"young", t.young}, {"poisson", t.poisson}};
  };
  Json json = {{"law", law_name(material.law)},
               {"plane", story.options.material.plane},
               {"breast", tissue(material.tissue)},
               {"regions", Json::object()}};
  for (const auto& [label, t] : material.regions)
    json["regions"][std::to_string(label)] = tissue(t);
  json["muscle_label"] = story.input.has_muscle() ? Json(story.input.muscle_label) : Json();
  return json;
}

Json load_steps_json(const LoadStepResult& load) {
  Json json = Json::array();
  for (const LoadStepRecord& step : load.steps) {
    json.push_back({{"step", step.step},
                    {"fraction", step.fraction},
                    {"newton_iterations", step.newton_iterations},
                    {"residual", step.residual()},
                    {"min_det", step.least_determinant},
                    {"largest_reaction", step.largest_reaction},
                    {"largest_reaction_pair", step.largest_reaction_row + 1},
                    {"factorizations", step.factorizations},
                    {"indefinite_tangent", step.indefinite_tangent}});
  }
  return json;
}

Json refinement_json(const ImageRefinementResult& refinement) {
  Json json = Json::array();
  for (const RefinementLevel& level : refinement.levels) {
    Json energies = Json::array(), steps = Json::array();
    for (const IterationRecord& record : level.history) {
      energies.push_back(record.value);
      if (record.iteration > 0) steps.push_back(record.step);
    }
    json.push_back({{"shrink", level.shrink},
                    {"size", level.size},
                    {"smoothing_mm", level.smoothing_mm},
                    {"alpha", level.weight},
                    {"iterations", level.iterations},
                    {"halvings", level.halvings},
                    {"energies", energies},
                    {"steps_pixels", steps},
                    {"metric", {{"before", level.metric_before}, {"after", level.metric_after}}},
                    {"elastic_energy", level.elastic_energy},
                    {"stopped_because", level.stopped_because},
                    {"interpolation_error_pixels", level.displacement_error_pixels}});
  }
  return json;
}

Json errors_json(const TargetErrors& errors) {
  Json json = {{"before", to_json(errors.before)}, {"pairs", to_json(errors.by_pairs)}};
  json["refinement"] = errors.by_images ? to_json(*errors.by_images) : Json();
  return json;
}

std::string pairs_text(const ElasticInput& input) {
  const int contour = input.num_contour_pairs(), given = input.num_given_pairs();
  std::vector<std::string> parts;
  if (contour > 0) {
    parts.push_back(fmt::format("{} along the skin by arc length{}", contour,
                                input.nipple_used ? ", split at the nipple" : ""));
  }
  if (input.num_pectoral_pairs > 0) {
    parts.push_back(fmt::format("{} along the muscle", input.num_pectoral_pairs));
  }
  if (given > 0) parts.push_back(fmt::format("{} given", given));
  return fmt::format("{}: {}", input.pairs.size(), fmt::join(parts, ", "));
}

std::string breast_text(const ElasticInput& input) {
  std::string text = fmt::format("{:.1f} cm2 fixed", input.region.area() / kSquareCentimetre);
  if (input.moving_region) {
    text += fmt::format(", {:.1f} cm2 moving{}", input.moving_region->area() / kSquareCentimetre,
                        input.mirrored ? ", mirrored" : "");
  }
  return text;
}

}  // namespace

std::string improvement_text(const ElasticRegistrationResult& found,
                             const std::optional<double>& percent) {
  if (found.images_equal) return "images already equal";
  if (!percent) return "not measured";
  std::string text = fmt::format("{:.2f} %", *percent);
  if (*percent < 0) text += ", the images are farther apart than before";
  return text;
}

Json figures_json(const ElasticStory& story) {
  const auto& registration = story.outcome.registration;
  const CreasedDomain& domain = story.outcome.domain;
  Json json;
  json["breast"] = breast_json(story.input);
  json["pairs"] = pairs_json(story);
  json["triangles"] = domain.mesh.mesh.simplices.size();
  json["control_points"] = domain.basis->num_control_points();
  json["unknowns"] = 2 * domain.basis->num_control_points();
  json["material"] = material_json(story);
  json["quadrature"] = {{"rule", story.options.quadrature},
                        {"relative_error", or_null(registration.load.quadrature_error)}};
  json["equilibrium"] = registration.load.fraction == 1;
  json["unstable_equilibrium"] = registration.load.unstable;
  json["load_fraction"] = registration.load.fraction;
  json["load_steps"] = load_steps_json(registration.load);
  json["refinement"] = registration.refinement ? refinement_json(*registration.refinement) : Json();
  json["factorizations"] = registration.factorizations;
  json["images_equal"] = registration.images_equal;
  json["improvement_percent"] = {{"pairs", or_null(registration.improvement_by_pairs)},
                                 {"refinement", or_null(registration.improvement_by_images)}};
  json["tre_mm"] = story.errors ? errors_json(*story.errors) : Json();
  json["jacobian"] = to_json(story.evaluation.jacobian);
  add_certificate(story.certificate, json["jacobian"]);
  json["notes"] = story.input.notes;
  for (const std::string& note : domain.notes) json["notes"].push_back(note);
  return json;
}

std::string summary_text(const ElasticStory& story, double seconds) {
  const auto& registration = story.outcome.registration;
  const CreasedDomain& domain = story.outcome.domain;
  std::string text;
  const auto line = [&](const std::string& name, const std::string& value) {
    text += fmt::format("{:<22} {}\n", name, value);
  };
  for (const std::string& note : story.input.notes) line("note", note);
  line("breast", breast_text(story.input));
  line("pairs", pairs_text(story.input));
  line("mesh", fmt::format("{} triangles, {} unknowns", domain.mesh.mesh.simplices.size(),
                           2 * domain.basis->num_control_points()));
  if (const auto& error = registration.load.quadrature_error) {
    line("quadrature",
         fmt::format("12 points per triangle, stiffness off by {:.2g} %", 100 * *error));
  }
  for (const LoadStepRecord& step : registration.load.steps) {
    line(fmt::format("load step {}", step.step),
         fmt::format("{:5.1f} %, {} Newton iterations, min det {:.3f}, largest reaction {:.4g} at "
                     "pair {}{}",
                     100 * step.fraction, step.newton_iterations, step.least_determinant,
                     step.largest_reaction, step.largest_reaction_row + 1,
                     step.indefinite_tangent ? ", tangent not positive definite" : ""));
  }
  if (registration.load.unstable) line("equilibrium", "unstable: a small push would end it");
  line("improvement",
       improvement_text(registration, registration.improvement_by_pairs) + " by the pairs");
  if (registration.refinement) {
    for (const RefinementLevel& level : registration.refinement->levels) {
      for (const IterationRecord& record : level.history) {
        line(fmt::format("refinement by {}", level.shrink),
             fmt::format("iteration {}, J {:.6g}, step {:.3f} pixels", record.iteration,
                         record.value, record.step));
      }
      line(fmt::format("refinement by {}", level.shrink), level.stopped_because);
    }
    line("improvement", improvement_text(registration, registration.improvement_by_images) +
                            " with the refinement");
  }
  if (story.errors) {
    const auto error = [](const ErrorStatistics& e) {
      return fmt::format("{:.3f} mm rms, {:.3f} mm at most", e.rms, e.maximum);
    };
    line("target error", error(story.errors->before) + " before");
    line("target error", error(story.errors->by_pairs) + " after the pairs");
    if (story.errors->by_images) {
      line("target error", error(*story.errors->by_images) + " after the refinement");
    }
  }
  line("Jacobian", fmt::format("{:.3f} to {:.3f}, {} of {} samples folded",
                               story.evaluation.jacobian.minimum, story.evaluation.jacobian.maximum,
                               story.evaluation.jacobian.folded, story.evaluation.samples));
  line("invertible", certificate_text(story.certificate));
  line("factorizations", fmt::format("{}, {:.2f} s", registration.factorizations, seconds));
  line("results", fmt::format("{0}; to look at it, open {0}/report.html", story.options.output));
  return text;
}

}  // namespace crease
