#include "Applications/Report/RegisterReport.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "Applications/CertificateReport.h"
#include "Applications/EvaluationReport.h"
#include "Applications/Report/ReportFolds.h"
#include "Applications/Report/ReportRun.h"
#include "Applications/Report/ReportText.h"

namespace crease {
namespace {

using Json = nlohmann::ordered_json;
using Statement = ReportHead::Statement;

constexpr double kRoundingMm = 1e-9;

std::string number_text(double value, int decimals) {
  return with_sign(fmt::format("{:.{}f}", value, decimals));
}

/// A length in mm; what is but rounding is 0.
std::string length_text(double mm) {
  constexpr double kSmall = 1e-3;
  if (mm < kRoundingMm) return "0";
  return mm < kSmall ? fmt::format("{:.1e}", mm) : fmt::format("{:.4f}", mm);
}

template <typename Vector>
std::string point_text(const Vector& p) {
  std::string text;
  for (Eigen::Index a = 0; a < p.size(); ++a) text += (a > 0 ? ", " : "") + number_text(p[a], 2);
  return text;
}

Statement status_of(const std::string& status) {
  if (status == "ok") return {ReportMood::kGood, "finished"};
  if (status == "gate_failed") return {ReportMood::kBad, "finished, but a quality gate failed"};
  return {ReportMood::kBad, "not converged"};
}

template <int Dim>
Statement match_statement(const RegisterStory<Dim>& story) {
  if (!story.options.has_metric()) {
    return {ReportMood::kPlain, "No images were compared: the map follows landmarks alone."};
  }
  if (!story.outcome.improved) {
    return {ReportMood::kBad, "The match did not improve."};
  }
  std::string text =
      fmt::format("The match improved: {} {} \u2192 {}", story.options.metric_name(),
                  short_text(story.outcome.metric_before), short_text(story.outcome.metric_after));
  if (const auto& match = story.evaluation.match; match && !std::isnan(match->ncc_before)) {
    text += fmt::format(", correlation {:.4f} \u2192 {:.4f}", match->ncc_before, match->ncc_after);
  }
  return {ReportMood::kGood, text + "."};
}

Statement landmark_statement(const Json& landmarks, bool exact) {
  const double largest = landmarks.at("max_error_mm");
  const int count = landmarks.at("count");
  constexpr double kRounding = 1e-6;  // mm
  if (exact && largest < kRounding) {
    return {ReportMood::kGood,
            fmt::format("{} landmark pair{} met exactly.", count, count == 1 ? " is" : "s are")};
  }
  return {exact ? ReportMood::kCaution : ReportMood::kPlain,
          fmt::format("{} landmark pairs: {:.3g} mm apart at most, rms {:.3g} mm.", count, largest,
                      landmarks.at("rms_error_mm").get<double>())};
}

template <int Dim>
std::vector<ReportHead::Figure> key_figures(const RegisterStory<Dim>& story) {
  const auto& [options, input, outcome, evaluation, certificate, result, config] = story;
  std::string size = count_text(outcome.free_parameters) + " parameters";
  if (outcome.domain) {
    size = fmt::format("{} triangles, {}", outcome.domain->mesh.mesh.simplices.size(), size);
  }
  std::vector<ReportHead::Figure> figures = {{"transform", options.transform, size}};
  if (const auto& match = evaluation.match) {
    const bool overlap = !std::isnan(match->ncc_before);
    figures.push_back(
        {"correlation (NCC)", fmt::format("{:.4f}", match->ncc_after),
         overlap ? fmt::format("{:.4f} before", match->ncc_before) : "no overlap before"});
    if (overlap && options.expects_equal_intensities()) {
      figures.push_back({"squared difference", number_text(-match->ssd_reduction_percent, 1) + " %",
                         "after against before"});
    }
  }
  const auto& jacobian = evaluation.jacobian;
  figures.push_back({"det \u2207T",
                     with_sign(fmt::format("{:.3g} to {:.3g}", jacobian.minimum, jacobian.maximum)),
                     fmt::format("{} folded samples", jacobian.folded)});
  if (!input.landmarks.empty()) {
    const double rms = result.at("landmarks").at("rms_error_mm");
    figures.push_back({"landmarks, rms", fmt::format("{:.3g} mm", rms < kRoundingMm ? 0 : rms),
                       fmt::format("{} pairs", input.landmarks.size())});
  }
  if (!evaluation.bodies.empty()) {
    double worst = 0;
    for (const auto& body : evaluation.bodies) worst = std::max(worst, body.rms_nonrigidity_mm);
    figures.push_back({"bodies, from rigid", fmt::format("{:.2g} mm", worst),
                       fmt::format("the worst of {}, rms", evaluation.bodies.size())});
  }
  int iterations = 0;
  for (const LevelReport& level : outcome.levels) iterations += level.iterations;
  const std::size_t levels = outcome.levels.size();
  figures.push_back(
      {!options.is_linear() ? "iterations" : "evaluations", std::to_string(iterations),
       !options.is_linear() ? fmt::format("on {} level{}", levels, levels == 1 ? "" : "s")
                            : "of the metric"});
  return figures;
}

template <int Dim>
ReportHead head_of(const RegisterStory<Dim>& story) {
  ReportHead head;
  head.command = "crease register";
  head.title = file_name(story.options.moving.front()) + " registered to " +
               file_name(story.options.fixed.front());
  if (const std::size_t channels = story.options.num_channels(); channels > 1) {
    head.title += fmt::format(", with {} further channel{}", channels - 1, channels > 2 ? "s" : "");
  }
  head.status = status_of(story.result.at("status"));
  head.verdict = {match_statement(story)};
  for (const auto& statement : fold_statements(story.evaluation, story.certificate))
    head.verdict.push_back(statement);
  if (!story.input.landmarks.empty()) {
    head.verdict.push_back(
        landmark_statement(story.result.at("landmarks"), story.options.landmarks_mode == "exact"));
  }
  if (!story.outcome.converged) {
    head.verdict.push_back(
        {ReportMood::kBad, "The optimisation ended early: " + story.outcome.stopped_because + "."});
  }
  const auto is_bad = [](const Statement& statement) { return statement.mood == ReportMood::kBad; };
  if (head.status.mood == ReportMood::kGood && std::ranges::any_of(head.verdict, is_bad)) {
    head.status.mood = ReportMood::kCaution;
  }
  head.figures = key_figures(story);
  head.warnings = story.result.at("warnings").template get<std::vector<std::string>>();
  return head;
}

std::string level_name(const LevelReport& level, std::size_t number) {
  return level.shrink > 1 ? fmt::format("level {}, 1:{}", number, level.shrink)
                          : fmt::format("level {}", number);
}

/// Of the terms that weigh something, the image's first.
std::vector<std::string> term_names(const std::map<std::string, double>& weights) {
  std::vector<std::string> names;
  for (const auto& [name, weight] : weights) {
    if (weight > 0) names.insert(name == "image" ? names.begin() : names.end(), name);
  }
  return names;
}

/// Weighted sum and terms per iteration, level after level. Where a minimisation is taken up anew without
/// a change of weights, its start is the point before.
ReportPlot energy_plot(const std::vector<LevelReport>& levels,
                       const std::map<std::string, double>& weights) {
  ReportPlot plot{.title = "Energy per iteration: the weighted sum and its terms",
                  .x_label = "iteration",
                  .y_label = "energy, weighted",
                  .sections = {},
                  .curves = {{"sum", {}}}};
  const std::vector<std::string> names = term_names(weights);
  for (const auto& name : names) {
    plot.curves.push_back({name == "image" ? "image metric" : name, {}});
  }
  for (std::size_t l = 0; l < levels.size(); ++l) {
    const auto& sums = levels[l].energy_history;
    plot.sections.push_back({level_name(levels[l], l + 1), 0});
    for (std::size_t i = 0; i < sums.size(); ++i) {
      constexpr double kRounding = 1e-12;
      if (i > 0 && std::abs(sums[i] - sums[i - 1]) <= kRounding * std::abs(sums[i])) continue;
      ++plot.sections.back().count;
      plot.curves[0].values.emplace_back(sums[i]);
      for (std::size_t n = 0; n < names.size(); ++n) {
        const auto& terms = levels[l].term_history[i];
        const auto term = terms.find(names[n]);
        plot.curves[n + 1].values.push_back(term != terms.end() ? std::optional(term->second)
                                                                : std::nullopt);
      }
    }
  }
  return plot;
}

void add_channels(const std::vector<ChannelReport>& channels, HtmlReport& report) {
  if (channels.size() < 2) return;
  ReportTable table{.title = "Channels, compared at once",
                    .columns = {"channel", "metric", "weight", "before", "after"},
                    .numbers = {2, 3, 4},
                    .note = "Differences are of the first channel; Compare shows all."};
  for (const ChannelReport& channel : channels) {
    table.rows.push_back({std::to_string(table.rows.size() + 1), channel.name,
                          short_text(channel.weight), short_text(channel.before),
                          short_text(channel.after)});
  }
  report.add_table(table);
}

void add_refinement(const std::vector<RefinementRound>& rounds, HtmlReport& report) {
  if (rounds.empty()) return;
  ReportTable table{
      .title = "Division of patches where the images asked for it",
      .columns = {"round", "control points", "places", "expected gain", "cost before", "cost", ""},
      .numbers = {1, 2, 3, 4, 5}};
  for (const RefinementRound& round : rounds) {
    table.rows.push_back({std::to_string(table.rows.size() + 1), count_text(round.control_points),
                          count_text(round.places), short_text(round.expected_gain),
                          short_text(round.cost_before), short_text(round.cost),
                          round.kept ? "kept" : "not kept: the cost did not fall"});
  }
  report.add_table(table);
}

template <int Dim>
void add_optimisation(const RegisterStory<Dim>& story, HtmlReport& report) {
  const auto& outcome = story.outcome;
  report.begin_section("optimisation", "Optimisation");
  add_channels(outcome.channels, report);
  if (story.options.is_linear()) {
    report.add_text("This transform is found by a search, not by levels of iterations: " +
                    outcome.stopped_because + ".");
    return;
  }
  const ReportPlot plot = energy_plot(outcome.levels, outcome.weights);
  if (plot.curves.front().values.size() > 1) {
    report.add_plot(plot);
    report.add_note("A new weight of bending, found at the end of a level, makes the sum jump.");
  }
  ReportTable levels{.title = "Levels, from coarse to fine",
                     .columns = {"level", "shrunk", "iterations", "evaluations", "stopped because"},
                     .numbers = {1, 2, 3}};
  for (std::size_t l = 0; l < outcome.levels.size(); ++l) {
    const LevelReport& level = outcome.levels[l];
    levels.rows.push_back(
        {std::to_string(l + 1), fmt::format("1:{}", level.shrink), std::to_string(level.iterations),
         std::to_string(level.evaluations),
         level.stopped_because.empty() ? outcome.stopped_because : level.stopped_because});
  }
  report.add_table(levels);
  add_refinement(outcome.refinement, report);
  if (const auto& unfolding = outcome.unfolding) {
    report.add_text(fmt::format(
        "The map folded (metric {}). It was made invertible in {} minimisations with an energy "
        "against "
        "folds, weight {} in the last; {:.3g} % of the way to the folded map were kept.",
        short_text(unfolding->folded_metric), unfolding->rounds, short_text(unfolding->weight),
        100 * unfolding->share));
  }
  ReportTable energies{.title = "Energies at the end",
                       .columns = {"term", "energy", "weight"},
                       .numbers = {1, 2},
                       .note = "The image term is the metric as result.json gives it."};
  for (const auto& [name, energy] : outcome.energies) {
    const auto weight = outcome.weights.find(name);
    energies.rows.push_back(
        {name, fmt::format("{:.5g}", energy),
         weight == outcome.weights.end() ? "\u2013" : fmt::format("{:.5g}", weight->second)});
  }
  report.add_table(energies);
}

template <int Dim>
void add_landmarks(const RegisterStory<Dim>& story, HtmlReport& report) {
  const Landmarks<Dim>& landmarks = story.input.landmarks;
  if (landmarks.empty()) {
    report.add_text("No landmarks were given.");
    return;
  }
  ReportTable table{.title = "Landmarks, in mm",
                    .columns = {"pair", "fixed", "moving", "apart before", "residual"},
                    .numbers = {1, 2, 3, 4},
                    .note = "Residual: from T(fixed) to moving."};
  const Json& errors = story.result.at("landmarks").at("errors_mm");
  for (std::size_t j = 0; j < landmarks.fixed.size(); ++j) {
    table.rows.push_back({std::to_string(j + 1), point_text(landmarks.fixed[j]),
                          point_text(landmarks.moving[j]),
                          fmt::format("{:.3f}", (landmarks.moving[j] - landmarks.fixed[j]).norm()),
                          length_text(errors.at(j).template get<double>())});
  }
  report.add_table(table);
}

template <int Dim>
void add_bodies(const RegisterStory<Dim>& story, HtmlReport& report) {
  if (story.evaluation.bodies.empty()) {
    report.add_text("No bodies were given or found.");
    return;
  }
  ReportTable table{
      .title = "Bodies and their best rigid fits",
      .columns = {"body", "samples", "angle, degrees", "shift, mm", "from rigid, mm (rms)"},
      .numbers = {1, 2, 3, 4}};
  for (const auto& body : story.evaluation.bodies) {
    table.rows.push_back({std::to_string(body.label), count_text(body.samples),
                          number_text(body.angle_deg, 3), point_text(body.shift_mm),
                          fmt::format("{:.4f}", body.rms_nonrigidity_mm)});
  }
  report.add_table(table);
}

}  // namespace

template <int Dim>
StackSources<Dim> stack_sources(const RegisterOptions& options, const RegisterInput<Dim>& input,
                                const RegisterOutcome<Dim>& outcome,
                                const RegisterImages<Dim>& images) {
  StackSources<Dim> sources{
      input.fixed.image,  input.moving.image, images.warped, images.before, images,
      *outcome.transform, input.landmarks};
  if (outcome.domain) sources.lines = outcome.domain->feature_lines;
  sources.equal_intensities = options.expects_equal_intensities();
  for (std::size_t c = 0; c < images.further_warped.size(); ++c) {
    sources.channels.push_back(
        {input.further_fixed[c].image, input.further_moving[c].image, images.further_warped[c]});
  }
  return sources;
}

template <int Dim>
std::string register_report(const RegisterStory<Dim>& story, ReportStacks<Dim>& stacks) {
  HtmlReport report(head_of(story));
  stacks.add_to(report);
  add_optimisation(story, report);
  report.begin_section("landmarks", "Landmarks and bodies");
  add_landmarks(story, report);
  add_bodies(story, report);
  add_run_section(story.result, story.config, report);
  return report.html();
}

template StackSources<2> stack_sources<2>(const RegisterOptions&, const RegisterInput<2>&,
                                          const RegisterOutcome<2>&, const RegisterImages<2>&);
template StackSources<3> stack_sources<3>(const RegisterOptions&, const RegisterInput<3>&,
                                          const RegisterOutcome<3>&, const RegisterImages<3>&);
template std::string register_report<2>(const RegisterStory<2>&, ReportStacks<2>&);
template std::string register_report<3>(const RegisterStory<3>&, ReportStacks<3>&);

}  // namespace crease
