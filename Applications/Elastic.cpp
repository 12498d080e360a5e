#include "Applications/Elastic.h"

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "Applications/ElasticFigures.h"
#include "Applications/EvaluationReport.h"
#include "Applications/Report/ElasticReport.h"
#include "Core/Error.h"

namespace crease {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kDetails =
    R"(Deforms the breast of the fixed image, an elastic body that is creased at the pectoral muscle, until its
point pairs lie where they belong in the moving image, and refines that by the intensities. Without --pairs
the breast, the muscle and pairs along the skin and the muscle's edge are found in the images; where St.
Venant-Kirchhoff tissue cannot follow these, neo-Hookean tissue is taken unless --material says otherwise.
Any other 2D images will do with --roi image or --roi FILE and --pairs FILE.

Writes into DIR: warped.* (the moving image on the fixed grid), displacement.mha (T(x) - x in mm),
jacobian.mha, transform.json (for crease warp: the refinement, then the deformation), pairs.csv (as they were
met), pictures/*.png (stiffness, mesh, jacobian, difference and more), report.html (one file for the
browser), config.toml and, last, result.json. Physical coordinates in mm (LPS) everywhere.

Exit code 5 where no equilibrium is found: the last one on the way is written, and the message says how far it
got, and where it failed; and where the refinement fails: what the pairs do is written.

Example: last year's mammogram onto this year's, with pairs inside the breast beside those along the skin
  crease elastic --fixed 2025.dcm --moving 2024.dcm --pairs vessels.csv --contour-pairs 40 --output compared)";

std::vector<std::string> input_files(const ElasticCommandOptions& o) {
  std::vector<std::string> files = {o.fixed, o.moving};
  files.insert(files.end(), o.pairs.begin(), o.pairs.end());
  if (o.roi_is_file()) files.push_back(o.roi);
  if (o.pectoral_is_file()) files.push_back(*o.pectoral);
  for (const auto* file : {&o.regions, &o.truth}) {
    if (*file) files.push_back(**file);
  }
  return files;
}

/// What the user should know about the outcome.
void add_warnings(const ElasticOutcome& outcome, const Evaluation<2>& evaluation,
                  RunReport& report) {
  const auto& registration = outcome.registration;
  if (evaluation.jacobian.folded > 0) {
    report.add_warning(folding_text(evaluation.jacobian, evaluation.samples) + ".");
  }
  for (const auto& percent :
       {registration.improvement_by_pairs, registration.improvement_by_images}) {
    if (!percent || *percent >= 0) continue;
    report.add_warning("the images are farther apart than before; look at the pairs.");
    return;
  }
}

ExitCode register_pair(const ElasticCommandOptions& options, const std::string& config,
                       RunReport& report, ProgressReporter& progress) {
  progress.report({.stage = "reading"});
  const ElasticInput input = read_input(options, report);
  const OutputFolder output(options.output, input_files(options));
  report.end_stage("reading");
  const ElasticOutcome outcome = run_elastic(options, input, report, progress);
  const auto certificate = certify_invertibility(*outcome.registration.transform);
  report.end_stage("certificate");
  progress.report({.stage = "results", .fraction = 0.9});
  ElasticImages images = make_images(input, outcome);
  const Evaluation<2> evaluation = evaluate_outcome(images);
  const auto errors = target_errors(input, outcome);
  report.end_stage("results");
  write_displacement(output, input, std::move(images.displacement));
  write_results(output, options, input, outcome, images);
  ReportStacks<2> stacks(stack_sources(input, outcome, images));
  write_pictures(output, input, outcome, images, stacks.jobs());
  output.write_text("config.toml", config);
  report.end_stage("writing");
  add_warnings(outcome, evaluation, report);
  for (const std::string& warning : report.warnings()) progress.warn(warning);

  const std::string& failure = outcome.registration.failure;
  const bool converged = failure.empty();
  if (!converged) report.add_warning(failure);
  const char* status = converged ? "ok" : "not_converged";
  const ElasticStory story{options, input, outcome, evaluation, certificate, errors};
  const Json figures = figures_json(story);
  output.write_text("report.html",
                    elastic_report(story, report.result(status, figures), config, stacks));
  report.end_stage("writing");
  const std::string json = report.to_json(status, figures);
  output.finish(json);
  std::cout << (options.run.json ? json : summary_text(story, report.elapsed_s()));
  if (!converged) throw SolverError(failure);  // all is written: what is left is to say why
  return ExitCode::kSuccess;
}

ExitCode run(const ElasticCommandOptions& options, const std::string& config) {
  check(options);
  RunReport report("elastic", prepare_process(options.run));
  ProgressReporter progress(options.run, "elastic");
  return register_pair(options, config, report, progress);
}

}  // namespace

Subcommand elastic_subcommand() {
  const auto options = std::make_shared<ElasticCommandOptions>();
  return {.name = "elastic",
          .summary = "Register two mammograms as elastic bodies",
          .details = kDetails,
          .options = options_of(*options),
          .exclusive = {{"mesh-size", "triangles"}, {"alpha", "alpha-relative"}},
          .run = [options](const std::string& config) { return run(*options, config); }};
}

}  // namespace crease
