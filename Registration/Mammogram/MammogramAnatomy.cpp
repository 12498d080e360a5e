#include "Registration/Mammogram/MammogramAnatomy.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <optional>

#include "Core/Error.h"
#include "Images/OpenCvView.h"

namespace crease {
namespace {

/// The breast's outline: the skin line, closed by the border along the frame. Where the two cross, the
/// border's points near the skin line's ends are left out.
Polyline closed_outline(const SkinContour& skin) {
  for (const double gap_mm : {0.0, 2.0, 5.0}) {
    Polyline outline = skin.outline;
    for (const auto& p : skin.rest) {
      const double to_ends =
          std::min((p - skin.points.front()).norm(), (p - skin.points.back()).norm());
      if (to_ends > gap_mm) outline.push_back(p);
    }
    if (!find_self_intersection(outline, true)) return outline;
  }
  return skin.outline;
}

void append(std::vector<std::string>& all, const std::vector<std::string>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

MammogramAnatomy analyse_mammogram(const Image<float, 2>& image, const MammogramOptions& wishes) {
  MammogramOptions options = wishes;  // every step gets the image's name and the user's wishes
  options.frame.name = options.breast.name = options.skin.name = options.name;
  options.skin.force = options.skin.force || options.force;
  MammogramAnatomy anatomy;
  anatomy.frame = find_frame(image, options.frame);
  if (options.threshold) {
    options.breast.threshold =
        anatomy.frame.inverted ? anatomy.frame.value_sum - *options.threshold : *options.threshold;
  }
  anatomy.breast = options.mask ? segmentation_of_mask(mask_in_frame(*options.mask, anatomy.frame),
                                                       options.breast)
                                : segment_breast(anatomy.frame.image, options.breast);
  anatomy.skin = find_skin_contour(anatomy.breast.mask, options.skin);
  if (options.pectoral_line) {
    anatomy.pectoral = pectoral_muscle_of(*options.pectoral_line, anatomy.frame.image,
                                          anatomy.breast, options.pectoral);
  } else if (options.pectoral_search == PectoralSearch::kAuto) {
    anatomy.pectoral = find_pectoral_muscle(anatomy.frame.image, anatomy.breast, options.pectoral);
  }
  anatomy.region = closed_outline(anatomy.skin);
  append(anatomy.notes, anatomy.frame.notes);
  append(anatomy.notes, anatomy.breast.notes);
  append(anatomy.warnings, anatomy.breast.warnings);
  return anatomy;
}

Polyline MammogramAnatomy::contour_below_pectoral() const {
  if (!pectoral) return skin.points;
  // The line ends in the breast's last pixel; the smoothed contour may pass beyond it.
  constexpr double kBeyond = 3;  // mm
  const Polyline& line = pectoral->line;
  const Point<2> end = line[0] + kBeyond * (line[0] - line[1]).normalized();
  const std::size_t upper_half = skin.points.size() / 2;
  for (std::size_t i = upper_half; i-- > 0;) {
    std::optional<Point<2>> crossing =
        segment_crossing(skin.points[i], skin.points[i + 1], end, line[0]);
    for (std::size_t k = 0; !crossing && 2 * k < line.size() && k + 1 < line.size(); ++k) {
      crossing = segment_crossing(skin.points[i], skin.points[i + 1], line[k], line[k + 1]);
    }
    if (!crossing) continue;
    Polyline below = {*crossing};
    below.insert(below.end(), skin.points.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                 skin.points.end());
    return below;
  }
  return skin.points;
}

std::vector<FeatureLine> MammogramAnatomy::feature_lines() const {
  if (!pectoral) return {};
  FeatureLine line;
  line.points = pectoral->line;
  line.name = "pectoral muscle";
  return {line};
}

AffineMap<2> MammogramAnatomy::to_given() const {
  return mirrored ? frame.reflection() : AffineMap<2>();
}

MammogramAnatomy mirrored(const MammogramAnatomy& anatomy) {
  MammogramAnatomy result = anatomy;
  const AffineMap<2> reflection = anatomy.frame.reflection();
  const auto reflect = [&](Polyline& points) {
    for (auto& p : points) p = reflection(p);
  };
  result.frame = mirrored(anatomy.frame);
  cv::Mat mask = opencv_view(result.breast.mask);
  cv::flip(opencv_view(anatomy.breast.mask), mask, 1);
  result.breast.side = opposite(anatomy.breast.side);
  reflect(result.skin.points);
  reflect(result.skin.outline);
  reflect(result.skin.rest);
  reflect(result.region);
  for (double& c : result.skin.curvature) c = -c;
  if (result.skin.nipple) result.skin.nipple->point = reflection(result.skin.nipple->point);
  if (result.pectoral) reflect(result.pectoral->line);
  result.mirrored = !anatomy.mirrored;
  return result;
}

std::vector<std::string> check_views(const MammogramAnatomy& fixed, const MammogramAnatomy& moving,
                                     bool force) {
  constexpr double kLargest = 0.4;
  std::vector<std::string> warnings;
  const double a = fixed.skin.length_mm, b = moving.skin.length_mm;
  if (std::abs(a - b) > kLargest * std::min(a, b)) {
    const std::string what =
        message("the skin contours differ in length by more than 40 %: ", std::lround(a),
                " mm in the fixed image, ", std::lround(b), " mm in the moving image");
    if (!force) {
      throw InvalidInput(what + "; do both show the same view? Go on all the same with --force.");
    }
    warnings.push_back(what);
  }
  if (fixed.breast.side != moving.breast.side) {
    warnings.push_back(message("the chest wall is on the ", to_string(fixed.breast.side),
                               " in the fixed image and on the ", to_string(moving.breast.side),
                               " in the moving image; mirror one of them"));
  }
  if (fixed.pectoral.has_value() != moving.pectoral.has_value()) {
    warnings.push_back(message("a pectoral muscle was found in the ",
                               fixed.pectoral ? "fixed" : "moving",
                               " image only; do both show the same view?"));
  }
  return warnings;
}

}  // namespace crease
