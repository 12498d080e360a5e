#pragma once

#include <functional>
#include <optional>

#include "Registration/Landmarks.h"
#include "Registration/Mammogram/MammogramAnatomy.h"

namespace crease {

struct ContourPairOptions {
  /// Pairs, ends included; fewer come back where known pairs say that the film cut an end. They are close
  /// enough for the skin not to dent between them, where nothing holds it.
  int count = 40;
  bool use_nipples = true;  ///< where both are known they are a pair
  /// h: [0, 1] -> [0, 1], monotone: the share of the moving contour that belongs to a share of the fixed one;
  /// null: arc length. With it nipples are not used: h should pass through them itself.
  std::function<double(double)> stretch;
  /// Pairs that are known beforehand. Those within `anchor_mm` of both contours split these too; they are not
  /// among the pairs found. Not used with a stretch.
  Landmarks<2> known = {};
  double anchor_mm = 3;
};

struct ContourPairs {
  Landmarks<2> landmarks;  ///< fixed and moving points, names "contour 1", .., "nipple"
  bool nipple_used = false;
  int num_anchors = 0;                               ///< known pairs that were used
  double fixed_length_mm = 0, moving_length_mm = 0;  ///< of the contours that were paired
};

/// Points of two skin lines that correspond by arc length: both contours, cut at the image's border and at the
/// pectoral line, run from t = 0 to t = 1, and pair k lies at t = k / (count - 1)
/// unless something else is known. A nipple known in both images
/// is a pair and splits the contours in two pieces, which share the other pairs by their lengths. Pairs known
/// beforehand split them further. Beyond the outermost of these at an end, if it lies in that quarter of the fixed
/// contour, both contours go on equally long, and pairs past the end of either are left out: the film may cut them differently.
/// Source: dissertation, chapter 4.2 (there 29 and 33 pairs).
/// @throws InvalidInput for fewer than 3 pairs, empty contours, or a stretch that is not monotone from 0 to 1.
ContourPairs contour_pairs(const MammogramAnatomy& fixed, const MammogramAnatomy& moving,
                           const ContourPairOptions& options = {});

/// The same for two polylines in mm; nipples are points on them.
ContourPairs contour_pairs(const Polyline& fixed, const Polyline& moving,
                           const std::optional<Point<2>>& fixed_nipple,
                           const std::optional<Point<2>>& moving_nipple,
                           const ContourPairOptions& options = {});

}  // namespace crease
