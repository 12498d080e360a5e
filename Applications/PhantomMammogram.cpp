#include "Applications/PhantomMammogram.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "Applications/ExitCode.h"
#include "Core/Error.h"
#include "Images/ImageFile.h"
#include "Transforms/Domains/FeatureLineFile.h"

namespace crease {
namespace {

using Json = nlohmann::ordered_json;
using Path = PhantomFiles::Path;

constexpr const char* kMassPlaces[] = {"none", "fixed", "moving"};

MammogramMassPlace mass_place(const std::string& name) {
  const auto* const found = std::find(std::begin(kMassPlaces), std::end(kMassPlaces), name);
  return static_cast<MammogramMassPlace>(found - std::begin(kMassPlaces));
}

void write_line(PhantomFiles& files, const std::string& name, const Polyline& points) {
  if (points.size() < 2) return;
  FeatureLine line;
  line.points = points;
  files.write(name, [&](const Path& p) { write_feature_lines(p, {line}); });
}

void write_marks(const Path& path, const std::vector<DuctMark>& marks) {
  std::ofstream stream(path);
  stream.precision(std::numeric_limits<double>::max_digits10);
  stream << "name,kind,x,y,angle_1,angle_2,angle_3\n";
  for (const DuctMark& mark : marks) {
    stream << mark.name << ',' << (mark.crossing ? "crossing" : "branch") << ','
           << mark.position.x() << ',' << mark.position.y();
    for (const double angle : mark.angles_rad) stream << ',' << angle;
    stream << (mark.crossing ? ",\n" : "\n");
  }
  stream.close();
  if (!stream) throw FileError(message(path.string(), ": cannot be written."));
}

// @param prefix  "" or "moving-".
void write_one(PhantomFiles& files, const std::string& image_name, const std::string& prefix,
               const MammogramImage& image, PixelType type) {
  files.write(image_name, [&](const Path& p) { write_image(p, image.pixels, type); });
  files.write(prefix + "mask.mha", [&](const Path& p) { write_mask(p, image.mask); });
  if (!image.labels.empty()) {
    files.write(prefix + "labels.mha", [&](const Path& p) { write_labels(p, image.labels); });
  }
  write_line(files, prefix + "outline.csv", image.outline);
  write_line(files, prefix + "feature-lines.csv", image.pectoral);
  files.write(prefix + "branches.csv", [&](const Path& p) { write_marks(p, image.marks); });
}

Json point(const Point<2>& p) { return {p.x(), p.y()}; }

Json counts(const MammogramImage& image) {
  const auto crossings = std::count_if(image.marks.begin(), image.marks.end(),
                                       [](const DuctMark& mark) { return mark.crossing; });
  return {{"nipple_mm", point(image.nipple)},
          {"branches", std::ssize(image.marks) - crossings},
          {"crossings", crossings}};
}

}  // namespace

std::string MammogramCommand::given() const {
  if (view) return "--view";
  if (temporal) return "--temporal";
  if (bilateral) return "--bilateral";
  if (elastic) return "--elastic";
  if (density) return "--density";
  if (bits) return "--bits";
  if (mass) return "--mass";
  return no_label ? "--no-label" : "";
}

std::vector<Option> options_of(MammogramCommand& c) {
  return {
      {.name = "view",
       .target = &c.view,
       .help = "Mammograms: from the side, with the pectoral muscle (mlo, default), or from above",
       .choices = {"mlo", "cc"}},
      {.name = "temporal",
       .target = &c.temporal,
       .help = "Mammograms: one breast at two times (default)"},
      {.name = "bilateral",
       .target = &c.bilateral,
       .help = "Mammograms: left and right breast; the moving image, and with it the true map, is "
               "mirrored"},
      {.name = "elastic",
       .target = &c.elastic,
       .help = "Mammograms: the motion is that of an elastic body whose pectoral muscle is ten "
               "times as "
               "stiff as the breast; without it all tissue moves smoothly"},
      {.name = "density",
       .target = &c.density,
       .placeholder = "D",
       .help = "Mammograms: of the gland, 0 fatty to 1 dense; without it 0.5",
       .minimum = 0,
       .maximum = 1},
      {.name = "bits",
       .target = &c.bits,
       .placeholder = "8|12|16",
       .help = "Mammograms: per pixel; without it 12",
       .minimum = 8,
       .maximum = 16},
      {.name = "mass",
       .target = &c.mass,
       .help = "Mammograms: the image that shows a mass of 4 to 12 mm in radius; without it none",
       .choices = {"none", "fixed", "moving"}},
      {.name = "no-label",
       .target = &c.no_label,
       .help = "Mammograms: no bright label on the film"},
  };
}

MammogramPhantomOptions phantom_options(const MammogramCommand& command) {
  if (command.temporal && command.bilateral) {
    throw UsageError("--temporal and --bilateral exclude each other.");
  }
  MammogramPhantomOptions options;
  if (command.view == "cc") options.view = MammogramView::kCc;
  if (command.bilateral) options.pair = MammogramPairKind::kBilateral;
  options.elastic = command.elastic;
  if (command.density) options.density = *command.density;
  if (command.bits) options.bits = *command.bits;
  if (options.bits != 8 && options.bits != 12 && options.bits != 16) {
    throw UsageError(message("--bits ", options.bits, ": choose 8, 12 or 16."));
  }
  if (command.mass) options.mass = mass_place(*command.mass);
  options.label = !command.no_label;
  return options;
}

void write_mammograms(PhantomFiles& files, const MammogramPhantom& phantom, int bits) {
  const PixelType type = bits == 8 ? PixelType::kUint8 : PixelType::kUint16;
  write_one(files, "fixed.mha", "", phantom.fixed, type);
  write_one(files, "moving.mha", "moving-", phantom.moving, type);
  files.write("landmarks.csv", [&](const Path& p) { write_landmarks(p, phantom.landmarks); });
  files.write("truth.mha",
              [&](const Path& p) { write_displacement_field(p, phantom.displacement); });
}

Json mammogram_description(const MammogramPhantom& phantom,
                           const MammogramPhantomOptions& options) {
  const bool bilateral = options.pair == MammogramPairKind::kBilateral;
  Json json = {{"kind", "mammogram"},
               {"dimension", 2},
               {"seed", options.seed},
               {"view", options.view == MammogramView::kMlo ? "mlo" : "cc"},
               {"pair", bilateral ? "bilateral" : "temporal"},
               {"moving_mirrored", bilateral},
               {"motion", options.elastic ? "elastic" : "smooth"},
               {"bits", options.bits},
               {"mass", kMassPlaces[static_cast<int>(options.mass)]},
               {"label", options.label},
               {"fixed", counts(phantom.fixed)},
               {"moving", counts(phantom.moving)}};
  Json& parameters = json["parameters"];
  parameters = {{"size", options.size}, {"density", options.density}, {"noise", options.noise}};
  for (const auto& [name, value] : phantom.parameters) parameters[name] = value;
  return json;
}

}  // namespace crease
