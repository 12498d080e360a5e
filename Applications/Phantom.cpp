#include "Applications/Phantom.h"

#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "Applications/ExitCode.h"
#include "Applications/PhantomFiles.h"
#include "Applications/PhantomMammogram.h"
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
  MammogramCommand mammogram;
};

constexpr const char* kMammogram = "mammogram";

constexpr const char* kDetails =
    R"(Writes fixed.mha, moving.mha, truth.mha (displacement on the fixed grid, mm), phantom.json, config.toml,
result.json and, as far as the kind has them, labels.mha, moving-labels.mha, feature-lines.csv and
landmarks.csv. Pixels are 1 mm; fixed(x) = moving(T(x)) exactly.

  square   a square on its tip turns by 45 degrees in a soft frame (400 pixels)
  bodies   a square, a square on its tip and a triangle move on their own (400)
  spine    five vertebrae with discs between them bend and stretch (512)
  blobs    soft blobs under a smooth random warp, no bodies (256; with --dimension 3 a volume, 96)

  mammogram   a breast with gland, milk ducts and pectoral muscle, twice (1024; the frame is 204.8 mm wide)

Mammograms differ by gain, gamma and noise as well, and masses, outlines and ducts are known in both: mask.mha,
outline.csv (skin line), branches.csv (where ducts fork or cross, with the directions of the ducts there in
radians from x to y) and the same with moving- before the name; feature-lines.csv is the edge of the pectoral
muscle, labels.mha the muscle; landmarks.csv holds pairs on the skin line, the nipple and forks of ducts;
phantom.json has nipples and all parameters. With --elastic the breast's border moves as smoothly as without, and its
inside as an elastic body does, with a kink at the muscle's edge.

Example:
  crease phantom spine --seed 7 --output spine
  crease register --fixed spine/fixed.mha --moving spine/moving.mha --rigid-labels spine/labels.mha \
      --landmarks spine/landmarks.csv --output spine/registered
  crease phantom mammogram --view cc --bilateral --density 0.8 --output breasts)";

std::vector<std::string> all_kinds() {
  auto kinds = phantom_kinds();
  kinds.emplace_back(kMammogram);
  return kinds;
}

std::vector<Option> options_of(PhantomCommand& c) {
  std::vector<Option> options = {
      {.name = "kind",
       .target = &c.kind,
       .help = "What to draw",
       .choices = all_kinds(),
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
       .help = "Pixels per axis, 64 to 4096 (mammograms: from 128), in 3D 16 to 512; without it "
               "the kind's own",
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
  for (const auto& more : {options_of(c.mammogram), options_of(c.run)}) {
    options.insert(options.end(), more.begin(), more.end());
  }
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

template <int Dim>
void write_images(PhantomFiles& files, const PhantomImages<Dim>& phantom) {
  using Path = PhantomFiles::Path;
  files.write("fixed.mha",
              [&](const Path& p) { write_image(p, phantom.fixed, PixelType::kFloat); });
  files.write("moving.mha",
              [&](const Path& p) { write_image(p, phantom.moving, PixelType::kFloat); });
  files.write("truth.mha",
              [&](const Path& p) { write_displacement_field(p, phantom.displacement); });
}

void write_bodies(PhantomFiles& files, const Phantom& phantom) {
  using Path = PhantomFiles::Path;
  if (!phantom.labels.empty()) {
    files.write("labels.mha", [&](const Path& p) { write_labels(p, phantom.labels); });
    files.write("moving-labels.mha",
                [&](const Path& p) { write_labels(p, phantom.moving_labels); });
  }
  if (!phantom.feature_lines.empty()) {
    files.write("feature-lines.csv",
                [&](const Path& p) { write_feature_lines(p, phantom.feature_lines); });
  }
  if (!phantom.landmarks.empty()) {
    files.write("landmarks.csv", [&](const Path& p) { write_landmarks(p, phantom.landmarks); });
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

// @throws UsageError when options contradict the kind or each other.
void check(const PhantomCommand& command) {
  const bool mammogram = command.kind == kMammogram;
  const int smallest = command.dimension == 3 ? 16 : mammogram ? 128 : 64;
  const int largest = command.dimension == 2 ? 4096 : 512;
  if (command.size && (*command.size < smallest || *command.size > largest)) {
    throw UsageError(
        message("--size ", *command.size, " is not in ", smallest, " .. ", largest, " pixels."));
  }
  if (command.dimension == 3 && command.kind != "blobs") {
    throw UsageError(
        message("--dimension 3: there are volumes of blobs only, not of ", command.kind, "."));
  }
  if (mammogram && (command.no_texture || command.landmark_noise != 0)) {
    throw UsageError(message(command.no_texture ? "--no-texture" : "--landmark-noise",
                             ": mammograms have textures and exact landmarks."));
  }
  if (!mammogram && !command.mammogram.given().empty()) {
    throw UsageError(
        message(command.mammogram.given(), " is for mammograms, not for ", command.kind, "."));
  }
  phantom_options(command.mammogram);
}

PhantomOptions phantom_options(const PhantomCommand& command) {
  return {.size = command.size.value_or(0),
          .seed = static_cast<std::uint64_t>(command.run.seed),
          .texture = !command.no_texture,
          .noise = command.noise,
          .landmark_noise_mm = command.landmark_noise};
}

ExitCode make_volume(const PhantomCommand& command, PhantomFiles& files, RunReport& report,
                     const std::string& config) {
  const VolumePhantom phantom = make_volume_phantom(command.kind, phantom_options(command));
  report.end_stage("phantom");
  write_images(files, phantom);
  const auto& size = phantom.fixed.size();
  return finish(files, command, report, config, description(phantom, command),
                fmt::format("{}: {} x {} x {} voxels, in {}\n", phantom.kind, size[0], size[1],
                            size[2], command.output));
}

ExitCode make_mammograms(const PhantomCommand& command, PhantomFiles& files, RunReport& report,
                         const std::string& config) {
  MammogramPhantomOptions options = phantom_options(command.mammogram);
  options.seed = static_cast<std::uint64_t>(command.run.seed);
  if (command.size) options.size = *command.size;
  if (command.noise) options.noise = *command.noise;
  const MammogramPhantom phantom = make_mammogram_phantom(options);
  report.end_stage("phantom");
  write_mammograms(files, phantom, options.bits);
  return finish(
      files, command, report, config, mammogram_description(phantom, options),
      fmt::format(
          "mammogram: {0} x {0} pixels, {1} branches and crossings, {2} landmarks, in {3}\n",
          options.size, phantom.fixed.marks.size(), phantom.landmarks.size(), command.output));
}

ExitCode make_image(const PhantomCommand& command, PhantomFiles& files, RunReport& report,
                    const std::string& config) {
  const Phantom phantom = make_phantom(command.kind, phantom_options(command));
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

ExitCode make(const PhantomCommand& command, const std::string& config) {
  check(command);
  RunReport report("phantom", prepare_process(command.run));
  ProgressReporter progress(command.run, "phantom");
  progress.report({.stage = "phantom"});
  PhantomFiles files(command.output);
  const auto make_kind = command.dimension == 3       ? make_volume
                         : command.kind == kMammogram ? make_mammograms
                                                      : make_image;
  return make_kind(command, files, report, config);
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
