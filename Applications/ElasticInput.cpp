#include "Applications/ElasticInput.h"

#include <algorithm>
#include <numeric>

#include "Applications/ExitCode.h"
#include "Applications/RegionInput.h"
#include "Images/IntensityRange.h"
#include "Images/RasterCheck.h"
#include "Registration/Elastic/BodyOutline.h"
#include "Registration/Elastic/PairPlaces.h"
#include "Registration/Mammogram/ContourPairs.h"
#include "Registration/Mammogram/GreyScale.h"
#include "Registration/Mammogram/PectoralPairs.h"
#include "Transforms/Domains/FeatureLineFile.h"

namespace crease {
namespace {

constexpr double kMuscleStiffness = 10;  // times that of the breast

void check_dimension(const ElasticCommandOptions& options) {
  if (InputFiles::common_dimension({options.fixed, options.moving}) == 2) return;
  throw InvalidInput(message(options.fixed, " is 3D; crease elastic works on 2D images."));
}

/// The one line of --pectoral FILE.
Polyline read_pectoral_line(const std::string& file, RunReport& report) {
  const auto lines = read_feature_lines(file);
  report.add_input("pectoral", file);
  if (lines.size() != 1 || lines[0].closed) {
    throw InvalidInput(message("--pectoral ", file,
                               ": one open line is needed, from the breast's upper "
                               "edge to the chest wall; the file has ",
                               lines.size(), lines.size() == 1 ? " closed line." : " lines."));
  }
  return lines[0].points;
}

/// Looks for film, breast, skin line and muscle.
MammogramAnatomy anatomy_of(const ElasticCommandOptions& options, const ReadImage<2>& read,
                            const std::string& file, bool is_fixed, std::vector<std::string>& notes,
                            RunReport& report) {
  MammogramOptions wanted;
  wanted.name = file;
  wanted.threshold = options.threshold;
  wanted.force = options.force;
  // Where --spacing was for another file, this one's own size stands in the raster.
  if (!options.spacing.empty()) wanted.frame.pixel_size_mm = read.image.raster().spacing.x();
  wanted.frame.spacing_known = read.spacing_known;
  if (options.pectoral_source() == "none") wanted.pectoral_search = PectoralSearch::kNone;
  if (is_fixed && options.pectoral_is_file()) {
    wanted.pectoral_line = read_pectoral_line(*options.pectoral, report);
  }
  MammogramAnatomy anatomy = analyse_mammogram(read.image, wanted);
  for (const std::string& note : anatomy.notes) notes.push_back(file + ": " + note);
  for (const std::string& warning : anatomy.warnings) report.add_warning(file + ": " + warning);
  return anatomy;
}

/// Brings the moving image to the fixed one's grey values where their bit depths differ, and where one of them was a
/// negative, whose film may have been less than white.
void take_grey_scale(const ElasticCommandOptions& options, ElasticInput& input) {
  Image<float, 2>& moving = input.moving.image;
  const double factor = bit_depth_ratio(moving, input.fixed.image);
  double shift = 0;
  if (input.fixed_anatomy->frame.inverted != input.moving_anatomy->frame.inverted) {
    shift = intensity_range(input.fixed.image).lower - factor * intensity_range(moving).lower;
  }
  if (factor == 1 && shift == 0) return;
  for (float& grey : moving.values()) grey = static_cast<float>(factor * grey + shift);
  input.moving.pixel_type = input.fixed.pixel_type;
  input.notes.push_back(message(options.moving, ": grey values were multiplied by ", factor,
                                " and shifted by ", shift, " to be on the scale of ",
                                options.fixed));
}

void look_at_mammograms(const ElasticCommandOptions& options, ElasticInput& input,
                        RunReport& report) {
  input.fixed_anatomy = anatomy_of(options, input.fixed, options.fixed, true, input.notes, report);
  input.moving_anatomy =
      anatomy_of(options, input.moving, options.moving, false, input.notes, report);
  MammogramAnatomy &fixed = *input.fixed_anatomy, &moving = *input.moving_anatomy;
  input.mirrored = options.mirror == "yes" ||
                   (options.mirror == "auto" && fixed.breast.side != moving.breast.side);
  if (input.mirrored) moving = mirrored(moving);
  input.to_given = moving.to_given();
  report.add_warnings(check_views(fixed, moving, options.force));
  input.fixed.image = upright_image(std::move(input.fixed.image), fixed.frame);
  input.moving.image = upright_image(std::move(input.moving.image), moving.frame);
  input.moving_region = RegionOfInterest({moving.region});
  take_grey_scale(options, input);
}

/// Where the muscle lies: the upper corner at the chest wall, as the picture is seen.
Point<2> chest_corner(const MammogramAnatomy& anatomy) {
  const Raster<2>& frame = anatomy.frame.image.raster();
  const double column = anatomy.breast.side == ChestSide::kLeft ? 0 : frame.size[0] - 1;
  return frame.point({column, 0});
}

void set_labels(const ElasticCommandOptions& options, const Raster<2>& given, ElasticInput& input,
                InputFiles& files) {
  if (!options.regions) return;
  const Raster<2>& fixed = input.fixed.image.raster();
  LabelImage<2> labels = files.labels<2>("regions", *options.regions);
  // A file of the same pixels without a size of its own means the same places.
  const bool same = same_raster(labels.raster(), given);
  input.labels =
      same ? LabelImage<2>(fixed, std::move(labels).take_values()) : on_raster(labels, fixed);
  if (std::ranges::max(input.labels->values()) > 0) return;
  throw InvalidInput(message("--regions ", *options.regions,
                             ": no label above 0 lies in the fixed image; label tissues 1, 2, ... "
                             "in its space."));
}

void set_muscle(const ElasticCommandOptions& options, ElasticInput& input, RunReport& report) {
  if (options.pectoral_source() == "none") return;
  const auto& muscle = input.fixed_anatomy->pectoral;
  if (!muscle) {
    report.add_warning("no pectoral muscle was found: the breast is taken as homogeneous.");
    return;
  }
  input.muscle_label = input.labels ? std::ranges::max(input.labels->values()) + 1 : 1;
  input.lines.push_back(outline_beyond(muscle->line, input.region.bounds(),
                                       chest_corner(*input.fixed_anatomy), input.muscle_label,
                                       "pectoral line"));
}

void set_body(const ElasticCommandOptions& options, const Raster<2>& given, ElasticInput& input,
              InputFiles& files, RunReport& report) {
  const Raster<2>& fixed = input.fixed.image.raster();
  if (options.roi == "auto") {
    input.region = RegionOfInterest({input.fixed_anatomy->region});
  } else if (options.roi == "image") {
    input.region = rectangle_of(fixed);
  } else {
    input.region = read_region(options.roi, fixed, files, report);
  }
  set_labels(options, given, input, files);
  set_muscle(options, input, report);
}

/// Pairs as they are given, into the moving image as it is given.
std::vector<std::string> snap_to_moving_body(ElasticInput& input) {
  if (!input.moving_region) {
    return snap_moving_points(input.pairs, rectangle_of(input.moving.image.raster()),
                              "the moving image");
  }
  std::vector<Polyline> rings = input.moving_region->rings();
  for (Polyline& ring : rings) {
    for (Point<2>& p : ring) p = input.to_given(p);
  }
  return snap_moving_points(input.pairs, RegionOfInterest(std::move(rings)));
}

void read_given_pairs(const ElasticCommandOptions& options, ElasticInput& input, InputFiles& files,
                      RunReport& report) {
  if (options.pairs.empty()) return;
  input.pairs = files.landmarks<2>("pairs", options.pairs);
  report.add_warnings(snap_to_moving_body(input));
  // A reflection is its own inverse.
  for (Point<2>& q : input.pairs.moving) q = input.to_given(q);
  input.pairs.sigma_mm.clear();     // all are met exactly
  input.pairs.fixed_angle.clear();  // directions are not used
  input.pairs.moving_angle.clear();
}

/// Adds pairs found in the images, but for those that others lie on.
/// @return the numbers of those added.
std::vector<int> append_found(const Landmarks<2>& found, ElasticInput& input, RunReport& report) {
  const int first = input.pairs.size();
  input.pairs.names.resize(static_cast<std::size_t>(first));
  const auto append = [](auto& to, const auto& more) {
    to.insert(to.end(), more.begin(), more.end());
  };
  append(input.pairs.fixed, found.fixed);
  append(input.pairs.moving, found.moving);
  append(input.pairs.names, found.names);
  std::vector<int> numbers(found.fixed.size());
  std::iota(numbers.begin(), numbers.end(), first);
  report.add_warnings(leave_out_found_pairs(input.pairs, numbers));
  return numbers;
}

/// Given pairs first, then those along the skin, then those along the muscle.
void set_pairs(const ElasticCommandOptions& options, ElasticInput& input, InputFiles& files,
               RunReport& report) {
  read_given_pairs(options, input, files, report);
  if (options.num_contour_pairs() > 0) {
    ContourPairOptions wanted;
    wanted.count = options.num_contour_pairs();
    wanted.known = input.pairs;
    const ContourPairs found = contour_pairs(*input.fixed_anatomy, *input.moving_anatomy, wanted);
    input.nipple_used = found.nipple_used;
    input.contour = append_found(found.landmarks, input, report);
  }
  if (options.num_pectoral_pairs() > 0) {
    const Landmarks<2> found =
        pectoral_pairs(*input.fixed_anatomy, *input.moving_anatomy, options.num_pectoral_pairs());
    input.num_pectoral_pairs = static_cast<int>(append_found(found, input, report).size());
  }
}

}  // namespace

ElasticInput::ElasticInput(ReadImage<2> fixed_image, ReadImage<2> moving_image)
    : fixed(std::move(fixed_image)),
      moving(std::move(moving_image)),
      region(rectangle_of(fixed.image.raster())) {}

ElasticBody ElasticInput::body(const MaterialOptions& material) const {
  ElasticBody body{region, lines, labels ? &*labels : nullptr, material_of(material)};
  if (has_muscle()) {
    const ElasticTissue& breast = body.material.tissue;
    body.material.regions.try_emplace(
        muscle_label, ElasticTissue{kMuscleStiffness * breast.young, breast.poisson});
  }
  return body;
}

ElasticInput read_input(const ElasticCommandOptions& options, RunReport& report) {
  check_dimension(options);
  InputFiles files(report, options.spacing);
  ReadImage<2> fixed = files.image<2>("fixed", options.fixed);
  const Raster<2> given = fixed.image.raster();
  ElasticInput input(std::move(fixed), files.image<2>("moving", options.moving));
  if (options.needs_anatomy()) look_at_mammograms(options, input, report);
  set_body(options, given, input, files, report);
  set_pairs(options, input, files, report);
  if (options.truth) input.truth = files.displacement<2>("truth", *options.truth);
  files.check_spacing_was_used();
  return input;
}

}  // namespace crease
