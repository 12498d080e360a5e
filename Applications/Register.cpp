#include "Applications/Register.h"

#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "Applications/CertificateReport.h"
#include "Applications/EvaluationReport.h"
#include "Applications/LandmarkErrors.h"
#include "Applications/RegisterInput.h"
#include "Applications/RegisterOptions.h"
#include "Applications/RegisterOutput.h"
#include "Applications/RegisterRun.h"
#include "Applications/Report/RegisterReport.h"

namespace crease {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kDetails =
    R"(Writes into DIR: warped.* (the moving image on the fixed grid; of further channels warped-2.* and so on),
displacement.mha (T(x) - x in mm),
jacobian.mha, transform.json (for crease warp), transform.tfm (for ITK, 3D Slicer and ANTs; rigid and
affine maps, B-splines of degree 1 to 3), pictures/*.png, report.html (one file for the browser, to judge
the result by looking), config.toml and, last, result.json.
Physical coordinates in mm (LPS) everywhere; T maps points of the fixed image to the moving image.

How exactly other programs repeat T: by transform.tfm to 1e-9 mm, B-splines within the fixed image's pixels
(beyond them only their affine part). By displacement.mha to rounding (1e-12 mm) at the centres of pixels;
between them linear interpolation misses T by up to h^2/8 times the second derivative of T along each
axis, h the size of a pixel, and near a crease by h/4 times the jump of the slope.

Example: two X-rays with rigid bones and some landmarks
  crease register --fixed monday.png --moving friday.png --spacing 0.2,0.2 --rigid-labels bones.png \
      --landmarks pairs.csv --init-transform rigid --output registered)";

Json energies_json(const std::map<std::string, double>& energies) {
  Json json = {{"image", 0.0}, {"rigidity", 0.0}, {"bending", 0.0}};
  for (const auto& [name, value] : energies) json[name] = value;
  return json;
}

Json levels_json(const std::vector<LevelReport>& levels) {
  Json json = Json::array();
  for (const LevelReport& level : levels) json.push_back(level.iterations);
  return json;
}

Json adaptation_json(const std::vector<RefinementRound>& rounds) {
  Json json = Json::array();
  for (const RefinementRound& round : rounds) {
    json.push_back({{"control_points", round.control_points},
                    {"places", round.places},
                    {"expected_gain", round.expected_gain},
                    {"cost_before", round.cost_before},
                    {"cost", round.cost},
                    {"kept", round.kept}});
  }
  return json;
}

Json metric_json(const RegisterOptions& options, double before, double after,
                 const std::vector<ChannelReport>& channels) {
  Json json = {{"name", options.metric_name()}, {"before", before}, {"after", after}};
  json["channels"] = Json::array();
  for (const ChannelReport& channel : channels) {
    json["channels"].push_back({{"name", channel.name},
                                {"before", channel.before},
                                {"after", channel.after},
                                {"weight", channel.weight}});
  }
  return json;
}

template <int Dim>
Json figures_json(const RegisterOptions& options, const RegisterInput<Dim>& input,
                  const RegisterOutcome<Dim>& outcome, const Evaluation<Dim>& evaluation,
                  const InvertibilityCertificate<Dim>& certificate) {
  const LandmarkErrors landmarks = landmark_errors(input.landmarks, *outcome.transform);
  Json json;
  json["metric"] =
      metric_json(options, outcome.metric_before, outcome.metric_after, outcome.channels);
  if (evaluation.match) {
    json["ssd_reduction_percent"] = evaluation.match->ssd_reduction_percent;
    json["ncc"] = {{"before", evaluation.match->ncc_before},
                   {"after", evaluation.match->ncc_after}};
  } else {
    json["ssd_reduction_percent"] = nullptr;
    json["ncc"] = nullptr;
  }
  json["energies"] = energies_json(outcome.energies);
  if (outcome.domain_measure > 0) {
    json["energies_per_measure"] = json["energies"];
    for (auto& value : json["energies_per_measure"]) {
      value = value.template get<double>() / outcome.domain_measure;
    }
  }
  json["weights"] = outcome.weights;
  json["iterations"] = levels_json(outcome.levels);
  if (!outcome.refinement.empty()) json["adaptation"] = adaptation_json(outcome.refinement);
  json["stopped_because"] = outcome.stopped_because;
  json["triangles"] = outcome.domain ? Json(outcome.domain->mesh.mesh.simplices.size()) : Json();
  json["control_points"] = outcome.control_points;
  json["free_parameters"] = outcome.free_parameters;
  json["jacobian"] = to_json(evaluation.jacobian);
  add_certificate(certificate, json["jacobian"]);
  if (outcome.unfolding) json["unfolding"] = to_json(*outcome.unfolding);
  json["landmarks"] = {{"count", input.landmarks.size()},
                       {"max_error_mm", landmarks.largest},
                       {"rms_error_mm", landmarks.rms},
                       {"errors_mm", landmarks.each}};
  json["bodies"] = Json::array();
  for (const auto& body : evaluation.bodies) json["bodies"].push_back(to_json(body));
  json["initial"] = {{"angle_deg", outcome.alignment.report.angle_deg},
                     {"shift_mm", outcome.alignment.report.shift_mm}};
  json["improved"] = outcome.improved;
  json["notes"] = outcome.domain ? outcome.domain->notes : std::vector<std::string>();
  return json;
}

template <int Dim>
std::string summary_text(const RegisterOptions& options, const RegisterInput<Dim>& input,
                         const RegisterOutcome<Dim>& outcome, const Evaluation<Dim>& evaluation,
                         const InvertibilityCertificate<Dim>& certificate, double seconds) {
  std::string text = options.transform;
  if (outcome.domain) {
    text += fmt::format(", {} triangles", outcome.domain->mesh.mesh.simplices.size());
  }
  if (outcome.control_points > 0)
    text += fmt::format(", {} control points", outcome.control_points);
  text += fmt::format(", {} free parameters, {:.2f} s\n", outcome.free_parameters, seconds);
  if (options.has_metric()) {
    text += fmt::format("{:<22} {:.5g} -> {:.5g}\n", options.metric_name(), outcome.metric_before,
                        outcome.metric_after);
    for (std::size_t c = 0; c < outcome.channels.size() && options.num_channels() > 1; ++c) {
      const ChannelReport& channel = outcome.channels[c];
      text += fmt::format("{:<22} {:.5g} -> {:.5g}\n",
                          fmt::format("  channel {}, {}", c + 1, channel.name), channel.before,
                          channel.after);
    }
  }
  text += summary(evaluation);
  text += fmt::format("{:<22} {}\n", "invertible", certificate_text(certificate));
  if (!input.landmarks.empty()) {
    const LandmarkErrors errors = landmark_errors(input.landmarks, *outcome.transform);
    text += fmt::format("{:<22} {} pairs, largest error {:.3g} mm, rms {:.3g} mm\n", "landmarks",
                        input.landmarks.size(), errors.largest, errors.rms);
  }
  text += fmt::format("{:<22} {}; to look at it, open {}/report.html\n", "results", options.output,
                      options.output);
  return text;
}

/// What the user should know about the outcome.
template <int Dim>
void add_warnings(const RegisterOutcome<Dim>& outcome, const Evaluation<Dim>& evaluation,
                  RunReport& report) {
  if (evaluation.jacobian.folded > 0) {
    report.add_warning(folding_text(evaluation.jacobian, evaluation.samples) + ".");
  }
  const bool told = !outcome.converged || outcome.control_points > 0;
  if (!outcome.improved && !told) {
    report.add_warning("the registration did not improve the match; the result is its start.");
  }
}

/// Whether the map is not what --require-invertible asks for; the report says why.
template <int Dim>
bool fails_gate(const RegisterOptions& options, const Evaluation<Dim>& evaluation,
                const InvertibilityCertificate<Dim>& certificate, RunReport& report) {
  if (!options.require_invertible || certificate.certified()) return false;
  if (certificate.verdict == Invertibility::kNotCertifiable) {
    report.add_warning(certificate_text(certificate) +
                       ": --require-invertible looked at the samples alone.");
    return evaluation.jacobian.folded > 0;
  }
  report.add_warning(message("no invertible map was found: ", certificate_text(certificate),
                             ". Look for exact landmarks near there that change sides, or make "
                             "them soft (--landmarks-mode soft)."));
  return true;
}

std::vector<std::string> input_files(const RegisterOptions& o) {
  std::vector<std::string> files = o.fixed;
  files.insert(files.end(), o.moving.begin(), o.moving.end());
  for (const auto* file :
       {&o.fixed_mask, &o.moving_mask, &o.roi, &o.rigid_labels, &o.feature_lines}) {
    if (*file) files.push_back(**file);
  }
  if (o.init_is_file()) files.push_back(*o.init);
  files.insert(files.end(), o.landmarks.begin(), o.landmarks.end());
  return files;
}

template <int Dim>
ExitCode register_images(const RegisterOptions& options, const std::string& config,
                         RunReport& report, ProgressReporter& progress) {
  progress.report({.stage = "reading"});
  const RegisterInput<Dim> input = read_input<Dim>(options, report);
  const OutputFolder output(options.output, input_files(options));
  report.end_stage("reading");
  const RegisterOutcome<Dim> outcome = run_registration(options, input, report, progress);
  const InvertibilityCertificate<Dim> certificate = certify_invertibility(*outcome.transform);
  report.end_stage("certificate");
  progress.report({.stage = "results", .fraction = 0.9});
  const RegisterImages<Dim> images = make_images(options, input, *outcome.transform);
  const Evaluation<Dim> evaluation = evaluate_outcome(options, input, outcome, images);
  report.end_stage("results");
  write_results(output, options, input, outcome, images);
  ReportStacks<Dim> stacks(stack_sources(options, input, outcome, images));
  write_pictures(output, options, input, outcome, images, stacks.jobs());
  output.write_text("config.toml", config);
  report.end_stage("writing");
  add_warnings(outcome, evaluation, report);
  const bool gate_failed = fails_gate(options, evaluation, certificate, report);
  for (const std::string& warning : report.warnings()) progress.warn(warning);

  if (!outcome.failure.empty()) report.add_warning(outcome.failure);
  const char* status = !outcome.converged ? "not_converged" : (gate_failed ? "gate_failed" : "ok");
  const Json figures = figures_json(options, input, outcome, evaluation, certificate);
  const Json result = report.result(status, figures);
  output.write_text("report.html", register_report<Dim>({options, input, outcome, evaluation,
                                                         certificate, result, config},
                                                        stacks));
  report.end_stage("writing");
  const std::string json = report.to_json(status, figures);
  output.finish(json);
  std::cout << (options.run.json ? json
                                 : summary_text(options, input, outcome, evaluation, certificate,
                                                report.elapsed_s()));
  if (!outcome.failure.empty()) throw SolverError(outcome.failure);  // all is written
  if (!outcome.converged) return ExitCode::kNotConverged;
  return gate_failed ? ExitCode::kGateFailed : ExitCode::kSuccess;
}

ExitCode run(const RegisterOptions& options, const std::string& config) {
  check(options);
  RunReport report("register", prepare_process(options.run));
  ProgressReporter progress(options.run, "register");
  return dimension_of(options) == 2 ? register_images<2>(options, config, report, progress)
                                    : register_images<3>(options, config, report, progress);
}

}  // namespace

Subcommand register_subcommand() {
  const auto options = std::make_shared<RegisterOptions>();
  return {.name = "register",
          .summary = "Register two images",
          .details = kDetails,
          .options = options_of(*options),
          .exclusive = {{"mesh-size", "triangles"}},
          .run = [options](const std::string& config) { return run(*options, config); }};
}

}  // namespace crease
