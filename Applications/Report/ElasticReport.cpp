#include "Applications/Report/ElasticReport.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "Applications/Report/ReportFolds.h"
#include "Applications/Report/ReportRun.h"
#include "Applications/Report/ReportText.h"
#include "Registration/Elastic/StiffnessMap.h"

namespace crease {
namespace {

using Json = nlohmann::ordered_json;

ReportMood mood_of(const std::optional<double>& percent) {
  if (!percent) return ReportMood::kPlain;
  return *percent > 0 ? ReportMood::kGood : ReportMood::kCaution;
}

ReportHead::Statement improvement_statement(const ElasticRegistrationResult& found) {
  std::string text =
      "Squared differences fell: " + improvement_text(found, found.improvement_by_pairs) +
      " by the pairs";
  if (found.refinement) {
    text += ", " + improvement_text(found, found.improvement_by_images) + " with the refinement";
  }
  if (found.images_equal) text = "The images are already equal";
  return {mood_of(found.refinement ? found.improvement_by_images : found.improvement_by_pairs),
          text + "."};
}

ReportHead head_of(const ElasticStory& story, const Json& result) {
  const auto& registration = story.outcome.registration;
  ReportHead head;
  head.command = "crease elastic";
  head.title = file_name(story.options.moving) + " deformed to " + file_name(story.options.fixed);
  const bool ok = result.at("status") == "ok";
  head.status = {ok ? ReportMood::kGood : ReportMood::kBad, ok ? "finished" : "not converged"};
  if (!registration.failure.empty()) {
    head.verdict.push_back({ReportMood::kBad, "No equilibrium: " + registration.failure});
  }
  head.verdict.push_back(improvement_statement(registration));
  for (const auto& statement : fold_statements(story.evaluation, story.certificate)) {
    head.verdict.push_back(statement);
  }
  const auto& jacobian = story.evaluation.jacobian;
  const auto& pairs = result.at("pairs");
  head.figures = {
      {"pairs", pairs.at("count").dump(),
       fmt::format("{} along the skin, {} along the muscle, {} given", pairs.at("contour").dump(),
                   pairs.at("pectoral").dump(), pairs.at("given").dump())},
      {"mesh", result.at("triangles").dump() + " triangles",
       result.at("unknowns").dump() + " unknowns"},
      {"improvement by the pairs",
       improvement_text(registration, registration.improvement_by_pairs), "of squared differences"},
      {"det \u2207T", fmt::format("{:.3g} to {:.3g}", jacobian.minimum, jacobian.maximum),
       fmt::format("{} folded samples", jacobian.folded)}};
  if (registration.refinement) {
    head.figures.insert(
        head.figures.begin() + 3,
        {"with the refinement", improvement_text(registration, registration.improvement_by_images),
         "of squared differences"});
  }
  if (story.errors) {
    const auto& last = story.errors->by_images ? *story.errors->by_images : story.errors->by_pairs;
    head.figures.push_back({"target error, rms", fmt::format("{:.3f} mm", last.rms),
                            fmt::format("{:.3f} mm before", story.errors->before.rms)});
  }
  head.warnings = result.at("warnings").get<std::vector<std::string>>();
  return head;
}

void add_load_steps(const ElasticStory& story, HtmlReport& report) {
  report.begin_section("load", "Load steps");
  report.add_text(
      "The pairs pull the body from rest to their places in steps; after each, Newton's method "
      "brings "
      "it to equilibrium. A pair with a reaction far above the others may be wrong.");
  if (const auto& error = story.outcome.registration.load.quadrature_error) {
    report.add_text(fmt::format(
        "Energies were integrated at 12 points per triangle: the stiffness matrix is off by {:.2g} "
        "% of its norm.",
        100 * *error));
  }
  ReportTable table{.title = "Load steps",
                    .columns = {"step", "load", "Newton iterations", "residual", "least det",
                                "largest reaction", "at pair", "factorizations", "tangent"},
                    .numbers = {0, 1, 2, 3, 4, 5, 6, 7}};
  for (const LoadStepRecord& step : story.outcome.registration.load.steps) {
    table.rows.push_back(
        {std::to_string(step.step), fmt::format("{:.1f} %", 100 * step.fraction),
         std::to_string(step.newton_iterations), fmt::format("{:.1e}", step.residual()),
         fmt::format("{:.3f}", step.least_determinant),
         fmt::format("{:.4g}", step.largest_reaction),
         std::to_string(step.largest_reaction_row + 1), std::to_string(step.factorizations),
         step.indefinite_tangent ? "not positive definite" : "positive definite"});
  }
  report.add_table(table);
  const LoadStepResult& load = story.outcome.registration.load;
  const Landmarks<2>& pairs = story.outcome.pairs;
  ReportTable reactions{.title = "Pairs and their reactions",
                        .columns = {"pair", "name", "fixed, mm", "displacement, mm", "reaction"},
                        .numbers = {0, 2, 3, 4}};
  for (int i = 0; i < pairs.size() && i < load.reactions.rows(); ++i) {
    const auto n = static_cast<std::size_t>(i);
    const Point<2>& p = pairs.fixed[n];
    reactions.rows.push_back({std::to_string(i + 1), n < pairs.names.size() ? pairs.names[n] : "",
                              fmt::format("{:.2f}, {:.2f}", p.x(), p.y()),
                              fmt::format("{:.2f}", (pairs.moving[n] - p).norm()),
                              fmt::format("{:.4g}", load.reactions.row(i).norm())});
  }
  report.add_table(reactions);
}

void add_refinement(const ElasticStory& story, HtmlReport& report) {
  report.begin_section("refinement", "Refinement");
  const auto& refinement = story.outcome.registration.refinement;
  if (!refinement) {
    report.add_text("The images were not used to refine the map.");
    return;
  }
  report.add_text(
      "A small displacement v on top of the pairs' deformation: J = elastic energy of v + alpha "
      "times "
      "the images' difference. Expect little of it: intensities draw to the nearest edge, right or "
      "not.");
  ReportTable table{.title = "Levels",
                    .columns = {"images by", "size", "smoothing, mm", "alpha", "iterations",
                                "J before", "J after", "last step, pixels", "stopped because"},
                    .numbers = {0, 1, 2, 3, 4, 5, 6, 7}};
  ReportPlot plot{.title = "J per iteration",
                  .x_label = "iteration",
                  .y_label = "J",
                  .sections = {},
                  .curves = {{"J", {}}}};
  for (const RefinementLevel& level : refinement->levels) {
    const bool ran = !level.history.empty();
    table.rows.push_back(
        {std::to_string(level.shrink), fmt::format("{} x {}", level.size[0], level.size[1]),
         fmt::format("{:g}", level.smoothing_mm), fmt::format("{:.4g}", level.weight),
         std::to_string(level.iterations),
         ran ? fmt::format("{:.6g}", level.history.front().value) : "",
         ran ? fmt::format("{:.6g}", level.history.back().value) : "",
         ran ? fmt::format("{:.3f}", level.history.back().step) : "", level.stopped_because});
    plot.sections.push_back(
        {fmt::format("by {}", level.shrink), static_cast<int>(level.history.size())});
    for (const auto& record : level.history) plot.curves[0].values.emplace_back(record.value);
  }
  report.add_table(table);
  if (!plot.curves[0].values.empty()) report.add_plot(std::move(plot));
}

}  // namespace

StackSources<2> stack_sources(const ElasticInput& input, const ElasticOutcome& outcome,
                              const ElasticImages& images) {
  StackSources<2> sources{input.fixed.image,
                          input.moving.image,
                          images.warped,
                          images.before,
                          images,
                          *outcome.registration.transform,
                          outcome.pairs};
  sources.lines = crease_lines(outcome.domain);
  sources.maps.push_back(
      {"Young's modulus", images.stiffness,
       report_scale(stiffness_scale(images.stiffness), "E, any unit of stress")});
  return sources;
}

std::string elastic_report(const ElasticStory& story, const Json& result, const std::string& config,
                           ReportStacks<2>& stacks) {
  HtmlReport report(head_of(story, result));
  stacks.add_to(report);
  add_load_steps(story, report);
  add_refinement(story, report);
  add_run_section(result, config, report);
  return report.html();
}

}  // namespace crease
