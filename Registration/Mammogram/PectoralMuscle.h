#pragma once

#include <optional>

#include "Images/Image.h"
#include "Registration/Mammogram/BreastSegmentation.h"
#include "Transforms/Domains/Polygon.h"

namespace crease {

/// How the pectoral muscle's edge is searched for. Lengths in mm.
struct PectoralOptions {
  double smallest_slope_deg = 20;  ///< against the chest wall
  double largest_slope_deg = 80;
  double edge_blur_mm = 1;    ///< Gaussian before edges are detected
  double skin_margin_mm = 4;  ///< edges nearer to the breast's border do not count
  double search_mm = 3;       ///< how far the path may leave the straight line
  double smoothing_mm = 0.4;  ///< rms distance of the path from its spline
  double band_near_mm = 1;    ///< the two bands along the line that the contrast compares
  double band_far_mm = 4;
  double smallest_contrast = 2;  ///< standard deviations
  double shortest_mm = 20;       ///< shorter lines are no muscle
};

/// The edge of the pectoral muscle in an oblique view.
struct PectoralMuscle {
  Polyline line;  ///< from its upper end (frame or skin) to its lower end (chest wall), mm
  /// Side towards the corner less the other side, in their pooled standard deviations; may be negative.
  double contrast = 0;
  bool given = false;  ///< the user's polyline, which may end elsewhere
};

/// The best straight line in the upper quadrant at the chest wall that is bright towards the corner (Hough
/// transform of Canny's edges), refined to the path of least cost sum 1/(1 + gradient) near it, smoothed by a
/// cubic B-spline and continued to the border of the breast. None: no line, or one that is short or of little
/// contrast, as in views from above.
/// @param image  the frame's; @param breast  on the same raster.
std::optional<PectoralMuscle> find_pectoral_muscle(const Image<float, 2>& image,
                                                   const BreastSegmentation& breast,
                                                   const PectoralOptions& options = {});

/// A polyline from elsewhere (mm), its contrast measured, its upper end first.
/// @throws InvalidInput when it has fewer than 2 points, one that is not finite, or none in the breast.
PectoralMuscle pectoral_muscle_of(Polyline line, const Image<float, 2>& image,
                                  const BreastSegmentation& breast,
                                  const PectoralOptions& options = {});

}  // namespace crease
