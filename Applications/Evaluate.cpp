#include "Applications/Evaluate.h"

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "Applications/CertificateReport.h"
#include "Applications/EvaluationReport.h"
#include "Applications/InputFiles.h"
#include "Applications/OutputFolder.h"
#include "Applications/ProgressReporter.h"
#include "Applications/RunReport.h"
#include "Applications/TransformImages.h"
#include "Applications/TransformInput.h"
#include "Transforms/JacobianMap.h"

namespace crease {
namespace {

struct EvaluateCommand {
  RunOptions run;
  std::optional<std::string> displacement, truth, labels, moving_labels, mask, fixed, moving,
      output;
  std::vector<std::string> transforms, landmarks;
  std::vector<double> spacing;
};

constexpr const char* kDetails =
    R"(Works on the displacement field (T(x) - x on the fixed grid, mm) of any tool, and on transform files; a
chain of transforms applies its first one first. A transform is evaluated on the grid of --fixed, --truth,
--labels or --mask, the first that is given. Labels and mask may lie on other grids.

Example:
  crease evaluate --displacement out/displacement.mha --truth spine/truth.mha --labels spine/labels.mha \
      --landmarks spine/landmarks.csv --fixed spine/fixed.mha --moving spine/moving.mha)";

std::vector<Option> options_of(EvaluateCommand& c) {
  const auto file = [](const char* name, std::optional<std::string>& target, const char* help) {
    return Option{
        .name = name, .target = &target, .placeholder = "FILE", .help = help, .is_path = true};
  };
  std::vector<Option> options = {
      file("displacement", c.displacement, "Displacement field to evaluate, mm"),
      {.name = "transform",
       .target = &c.transforms,
       .placeholder = "FILE",
       .help = "Transform to evaluate instead; given several times, a chain",
       .is_path = true},
      file("truth", c.truth, "True displacement field"),
      {.name = "landmarks",
       .target = &c.landmarks,
       .placeholder = "FILE",
       .help = "Pairs of points: CSV, or given twice, two files of 3D Slicer, fixed first",
       .is_path = true},
      file("labels", c.labels, "Labels of the fixed image: rigid bodies or organs"),
      file("moving-labels", c.moving_labels, "The same labels in the moving image"),
      file("mask", c.mask, "Samples count where it is not 0"),
      file("fixed", c.fixed, "Fixed image"),
      file("moving", c.moving, "Moving image"),
      {.name = "spacing",
       .target = &c.spacing,
       .placeholder = "X,Y[,Z]",
       .help = "Pixel size in mm of images whose files tell none",
       .minimum = 0,
       .open_minimum = true},
      {.name = "output",
       .target = &c.output,
       .placeholder = "DIR",
       .help = "Write result.json there, too",
       .is_path = true,
       .short_name = "o"},
  };
  const auto run = options_of(c.run);
  options.insert(options.end(), run.begin(), run.end());
  return options;
}

void check(const EvaluateCommand& c) {
  if (!c.displacement && c.transforms.empty()) {
    throw UsageError("nothing to evaluate: give --displacement FILE or --transform FILE.");
  }
  if (c.moving && !c.fixed) throw UsageError("--moving needs --fixed to be compared with.");
  if (c.moving_labels && !c.labels) {
    throw UsageError("--moving-labels needs --labels to be compared with.");
  }
  if (!c.displacement && !c.fixed && !c.truth && !c.labels && !c.mask) {
    throw UsageError("--transform needs a grid: give --fixed, --truth, --labels or --mask.");
  }
  if (c.displacement && c.fixed && !c.moving) throw UsageError("--fixed needs --moving.");
}

/// The first file that has a grid.
std::string grid_file(const EvaluateCommand& c) {
  for (const auto* file : {&c.fixed, &c.truth, &c.labels, &c.mask}) {
    if (*file) return **file;
  }
  return {};
}

/// Everything that was given, read.
template <int Dim>
struct EvaluationFiles {
  std::optional<DisplacementField<Dim>> displacement, truth;
  std::unique_ptr<Transform<Dim>> transform;
  std::optional<Image<float, Dim>> determinants, fixed, moving;
  std::optional<LabelImage<Dim>> labels, moving_labels;
  std::optional<Mask<Dim>> mask;
  Landmarks<Dim> landmarks;

  Raster<Dim> raster() const {
    if (fixed) return fixed->raster();
    if (truth) return truth->raster();
    return labels ? labels->raster() : mask->raster();
  }
};

template <int Dim>
EvaluationFiles<Dim> read_files(const EvaluateCommand& c, RunReport& report) {
  EvaluationFiles<Dim> files;
  InputFiles input(report, c.spacing);
  if (c.displacement) files.displacement = input.displacement<Dim>("displacement", *c.displacement);
  if (c.truth) files.truth = input.displacement<Dim>("truth", *c.truth);
  if (c.fixed) files.fixed = input.image<Dim>("fixed", *c.fixed).image;
  if (c.moving) files.moving = input.image<Dim>("moving", *c.moving).image;
  if (c.labels) files.labels = input.labels<Dim>("labels", *c.labels);
  if (c.moving_labels) files.moving_labels = input.labels<Dim>("moving-labels", *c.moving_labels);
  if (c.mask) files.mask = input.mask<Dim>("mask", *c.mask);
  if (!c.landmarks.empty()) files.landmarks = input.landmarks<Dim>("landmarks", c.landmarks);
  input.check_spacing_was_used();
  if (!c.transforms.empty()) files.transform = read_transforms<Dim>(report, c.transforms);
  return files;
}

/// The field and determinants of a transform on the grid of the other files.
template <int Dim>
void sample_transform(EvaluationFiles<Dim>& files) {
  TransformImages<Dim> images = transform_images(*files.transform, files.raster());
  files.displacement = std::move(images.displacement);
  files.determinants = std::move(images.determinants);
}

template <int Dim>
ExitCode evaluate_files(const EvaluateCommand& command, const std::string& config,
                        RunReport& report, ProgressReporter& progress) {
  progress.report({.stage = "reading"});
  EvaluationFiles<Dim> files = read_files<Dim>(command, report);
  report.end_stage("reading");
  progress.report({.stage = "evaluation", .fraction = 0.3});
  EvaluationInput<Dim> input;
  if (files.transform) {
    sample_transform(files);
    input.map = [&files](const Point<Dim>& x) { return files.transform->map(x); };
    input.determinants = &*files.determinants;
  }
  const auto pointer = [](const auto& file) { return file ? &*file : nullptr; };
  input.displacement = pointer(files.displacement);
  input.truth = pointer(files.truth);
  input.labels = pointer(files.labels);
  input.moving_labels = pointer(files.moving_labels);
  input.mask = pointer(files.mask);
  if (files.moving) {
    input.fixed = pointer(files.fixed);
    input.moving = pointer(files.moving);
  }
  input.landmarks = files.landmarks;
  const Evaluation<Dim> evaluation = evaluate(input);
  std::optional<InvertibilityCertificate<Dim>> certificate;
  if (files.transform) certificate = certify_invertibility(*files.transform);
  if (evaluation.jacobian.folded > 0) {
    report.add_warning(folding_text(evaluation.jacobian, evaluation.samples) + ".");
  }
  report.end_stage("evaluation");
  for (const std::string& warning : report.warnings()) progress.warn(warning);
  auto figures = to_json(evaluation);
  std::string text = summary(evaluation);
  if (certificate) {
    add_certificate(*certificate, figures["jacobian"]);
    text += "invertible             " + certificate_text(*certificate) + "\n";
  }
  const std::string json = report.to_json("ok", figures);
  if (command.output) {
    const OutputFolder output(*command.output);
    output.write_text("config.toml", config);
    output.finish(json);
  }
  std::cout << (command.run.json ? json : text);
  return ExitCode::kSuccess;
}

ExitCode run(const EvaluateCommand& command, const std::string& config) {
  check(command);
  RunReport report("evaluate", prepare_process(command.run));
  ProgressReporter progress(command.run, "evaluate");
  const int dimension = command.displacement ? read_image_header(*command.displacement).dimension
                                             : transform_dimension(command.transforms);
  const std::string grid = grid_file(command);
  if (!grid.empty() && read_image_header(grid).dimension != dimension) {
    throw InvalidInput(
        message(command.displacement ? *command.displacement : command.transforms.front(), " is ",
                dimension, "D, but ", grid, " is not; give files of the same dimension."));
  }
  return dimension == 2 ? evaluate_files<2>(command, config, report, progress)
                        : evaluate_files<3>(command, config, report, progress);
}

}  // namespace

Subcommand evaluate_subcommand() {
  const auto command = std::make_shared<EvaluateCommand>();
  return {.name = "evaluate",
          .summary = "Measure errors, folds and match of a registration",
          .details = kDetails,
          .options = options_of(*command),
          .exclusive = {{"displacement", "transform"}},
          .run = [command](const std::string& config) { return run(*command, config); }};
}

}  // namespace crease
