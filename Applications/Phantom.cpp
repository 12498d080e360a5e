#include "Applications/Phantom.h"

#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "Applications/ExitCode.h"
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
  int dimension = 2;
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
  blobs    soft blobs under a smooth random warp, no bodies (256; with --dimension 3 a volume, 96)

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
       .help = "Pixels per axis, 64 to 4096, in 3D 16 to 512; without it the kind's own",
       .minimum = 16,
       .maximum = 4096},
      {.name = "dimension",
       .target = &c.dimension,
       .placeholder = "2|3",
       .help = "3 makes volumes: blobs alone",
       .minimum = 2,
       .maximum = 3},
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

template <int Dim>
Json description(const PhantomImages<Dim>& phantom, const PhantomCommand& command) {
  Json json = {{"kind", phantom.kind}, {"dimension", Dim}, {"seed", command.run.seed}};
  for (const auto& [name, value] : phantom.parameters) json["parameters"][name] = value;
  return json;
}

Json body_list(const Phantom& phantom) {
  Json bodies = Json::array();
  for (const PhantomBody& body : phantom.bodies) {
    bodies.push_back({{"label", body.label},
                      {"angle_deg", body.angle_deg},
                      {"center_mm", {body.center.x(), body.center.y()}},
                      {"shift_mm", {body.shift_mm.x(), body.shift_mm.y()}}});
  }
  return bodies;
}

/// Writes files and remembers their names.
class PhantomFiles {
 public:
  using Path = std::filesystem::path;
  explicit PhantomFiles(const std::string& folder) : output_(folder) {}

  void write(const char* name, const std::function<void(const Path&)>& writer) {
    output_.write(name, writer);
    names_.emplace_back(name);
  }
  void write_text(const char* name, const std::string& text) {
    output_.write_text(name, text);
    names_.emplace_back(name);
  }
  const OutputFolder& output() const { return output_; }
  const std::vector<std::string>& names() const { return names_; }

 private:
  OutputFolder output_;
  std::vector<std::string> names_;
};

template <int Dim>
void write_images(PhantomFiles& files, const PhantomImages<Dim>& phantom) {
  using Path = std::filesystem::path;
  const auto write = [&](const char* name, const std::function<void(const Path&)>& writer) {
    files.write(name, writer);
  };
  write("fixed.mha", [&](const Path& p) { write_image(p, phantom.fixed, PixelType::kFloat); });
  write("moving.mha", [&](const Path& p) { write_image(p, phantom.moving, PixelType::kFloat); });
  write("truth.mha", [&](const Path& p) { write_displacement_field(p, phantom.displacement); });
}

void write_bodies(PhantomFiles& files, const Phantom& phantom) {
  using Path = std::filesystem::path;
  const auto write = [&](const char* name, const std::function<void(const Path&)>& writer) {
    files.write(name, writer);
  };
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
}

/// What is written last: the phantom's figures and the report.
ExitCode finish(PhantomFiles& files, const PhantomCommand& command, RunReport& report,
                const std::string& config, Json figures, const std::string& summary) {
  files.write_text("phantom.json", figures.dump(2) + "\n");
  figures["files"] = files.names();
  files.output().write_text("config.toml", config);
  report.end_stage("writing");
  const std::string json = report.to_json("ok", figures);
  files.output().finish(json);
  std::cout << (command.run.json ? json : summary);
  return ExitCode::kSuccess;
}

ExitCode make(const PhantomCommand& command, const std::string& config) {
  const int smallest = command.dimension == 2 ? 64 : 16;
  const int largest = command.dimension == 2 ? 4096 : 512;
  if (command.size && (*command.size < smallest || *command.size > largest)) {
    throw UsageError(
        message("--size ", *command.size, " is not in ", smallest, " .. ", largest, " pixels."));
  }
  if (command.dimension == 3 && command.kind != "blobs") {
    throw UsageError(
        message("--dimension 3: there are volumes of blobs only, not of ", command.kind, "."));
  }
  RunReport report("phantom", prepare_process(command.run));
  ProgressReporter progress(command.run, "phantom");
  progress.report({.stage = "phantom"});
  PhantomFiles files(command.output);
  const PhantomOptions options = {.size = command.size.value_or(0),
                                  .seed = static_cast<std::uint64_t>(command.run.seed),
                                  .texture = !command.no_texture,
                                  .noise = command.noise,
                                  .landmark_noise_mm = command.landmark_noise};
  if (command.dimension == 3) {
    const VolumePhantom phantom = make_volume_phantom(command.kind, options);
    report.end_stage("phantom");
    write_images(files, phantom);
    const auto& size = phantom.fixed.size();
    return finish(files, command, report, config, description(phantom, command),
                  fmt::format("{}: {} x {} x {} voxels, in {}\n", phantom.kind, size[0], size[1],
                              size[2], command.output));
  }
  const Phantom phantom = make_phantom(command.kind, options);
  report.end_stage("phantom");
  write_images(files, phantom);
  write_bodies(files, phantom);
  Json figures = description(phantom, command);
  figures["bodies"] = body_list(phantom);
  return finish(files, command, report, config, figures,
                fmt::format("{}: {} x {} pixels, {} bodies, {} landmarks, in {}\n", phantom.kind,
                            phantom.fixed.size()[0], phantom.fixed.size()[1], phantom.bodies.size(),
                            phantom.landmarks.size(), command.output));
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
