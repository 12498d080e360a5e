#include "Applications/Phantom.h"

#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "Applications/OutputFolder.h"
#include "Applications/ProgressReporter.h"
#include "Applications/RunReport.h"
#include "Images/ImageFile.h"
#include "Registration/Phantoms/Phantom.h"
#include "Transforms/Domains/FeatureLineFile.h"

namespace crease {
namespace {

using Json = nlohmann::ordered_json;

struct PhantomCommand {
  RunOptions run;
  std::string kind, output;
  std::optional<int> size;
  std::optional<double> noise;
  bool no_texture = false;
  double landmark_noise = 0;
};

constexpr const char* kDetails =
    R"(Writes fixed.mha, moving.mha, truth.mha (displacement on the fixed grid, mm), phantom.json, config.toml,
result.json and, as far as the kind has them, labels.mha, moving-labels.mha, feature-lines.csv and
landmarks.csv. Pixels are 1 mm; fixed(x) = moving(T(x)) exactly.

  square   a square on its tip turns by 45 degrees in a soft frame (400 pixels)
  bodies   a square, a square on its tip and a triangle move on their own (400)
  spine    five vertebrae with discs between them bend and stretch (512)
  blobs    soft blobs under a smooth random warp, no bodies (256)

Example:
  crease phantom spine --seed 7 --output spine
  crease register --fixed spine/fixed.mha --moving spine/moving.mha --rigid-labels spine/labels.mha \
      --landmarks spine/landmarks.csv --output spine/registered)";

std::vector<Option> options_of(PhantomCommand& c) {
  std::vector<Option> options = {
      {.name = "kind",
       .target = &c.kind,
       .help = "What to draw",
       .choices = phantom_kinds(),
       .required = true,
       .positional = true},
      {.name = "output",
       .target = &c.output,
       .placeholder = "DIR",
       .help = "Folder of the results; made if missing",
       .required = true,
       .is_path = true,
       .short_name = "o"},
      {.name = "size",
       .target = &c.size,
       .placeholder = "N",
       .help = "Pixels per axis; without it the kind's own",
       .minimum = 64,
       .maximum = 4096},
      {.name = "noise",
       .target = &c.noise,
       .placeholder = "S",
       .help = "Deviation of the pixel noise, intensities being about 0 to 1; without it the "
               "kind's own",
       .minimum = 0,
       .maximum = 0.5},
      {.name = "no-texture", .target = &c.no_texture, .help = "Plain greys without texture"},
      {.name = "landmark-noise",
       .target = &c.landmark_noise,
       .placeholder = "MM",
       .help = "Deviation of each coordinate of the moving landmarks",
       .minimum = 0,
       .maximum = 64},
  };
  const auto run = options_of(c.run);
  options.insert(options.end(), run.begin(), run.end());
  return options;
}

Json description(const Phantom& phantom, const PhantomCommand& command) {
  Json json = {{"kind", phantom.kind}, {"seed", command.run.seed}};
  for (const auto& [name, value] : phantom.parameters) json["parameters"][name] = value;
  json["bodies"] = Json::array();
  for (const PhantomBody& body : phantom.bodies) {
    json["bodies"].push_back({{"label", body.label},
                              {"angle_deg", body.angle_deg},
                              {"center_mm", {body.center.x(), body.center.y()}},
                              {"shift_mm", {body.shift_mm.x(), body.shift_mm.y()}}});
  }
  return json;
}

/// @return the names of the files written.
std::vector<std::string> write_phantom(const OutputFolder& output, const Phantom& phantom,
                                       const Json& description) {
  using Path = std::filesystem::path;
  std::vector<std::string> files;
  const auto write = [&](const char* name, const std::function<void(const Path&)>& writer) {
    output.write(name, writer);
    files.emplace_back(name);
  };
  write("fixed.mha", [&](const Path& p) { write_image(p, phantom.fixed, PixelType::kFloat); });
  write("moving.mha", [&](const Path& p) { write_image(p, phantom.moving, PixelType::kFloat); });
  write("truth.mha", [&](const Path& p) { write_displacement_field(p, phantom.displacement); });
  if (!phantom.labels.empty()) {
    write("labels.mha", [&](const Path& p) { write_labels(p, phantom.labels); });
    write("moving-labels.mha", [&](const Path& p) { write_labels(p, phantom.moving_labels); });
  }
  if (!phantom.feature_lines.empty()) {
    write("feature-lines.csv",
          [&](const Path& p) { write_feature_lines(p, phantom.feature_lines); });
  }
  if (!phantom.landmarks.empty()) {
    write("landmarks.csv", [&](const Path& p) { write_landmarks(p, phantom.landmarks); });
  }
  output.write_text("phantom.json", description.dump(2) + "\n");
  files.emplace_back("phantom.json");
  return files;
}

ExitCode make(const PhantomCommand& command, const std::string& config) {
  RunReport report("phantom", prepare_process(command.run));
  ProgressReporter progress(command.run, "phantom");
  progress.report({.stage = "phantom"});
  const OutputFolder output(command.output);
  const Phantom phantom =
      make_phantom(command.kind, {.size = command.size.value_or(0),
                                  .seed = static_cast<std::uint64_t>(command.run.seed),
                                  .texture = !command.no_texture,
                                  .noise = command.noise,
                                  .landmark_noise_mm = command.landmark_noise});
  report.end_stage("phantom");
  Json figures = description(phantom, command);
  figures["files"] = write_phantom(output, phantom, figures);
  output.write_text("config.toml", config);
  report.end_stage("writing");
  const std::string json = report.to_json("ok", figures);
  output.finish(json);
  if (command.run.json) {
    std::cout << json;
  } else {
    std::cout << fmt::format("{}: {} x {} pixels, {} bodies, {} landmarks, in {}\n", phantom.kind,
                             phantom.fixed.size()[0], phantom.fixed.size()[1],
                             phantom.bodies.size(), phantom.landmarks.size(), command.output);
  }
  return ExitCode::kSuccess;
}

}  // namespace

Subcommand phantom_subcommand() {
  const auto command = std::make_shared<PhantomCommand>();
  return {.name = "phantom",
          .summary = "Make two test images whose true map is known",
          .details = kDetails,
          .options = options_of(*command),
          .run = [command](const std::string& config) { return make(*command, config); }};
}

}  // namespace crease
