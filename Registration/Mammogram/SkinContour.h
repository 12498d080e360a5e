#pragma once

#include <optional>
#include <string>
#include <vector>

#include "Images/Image.h"
#include "Transforms/Domains/Polygon.h"

namespace crease {

/// How the skin line is followed. Lengths in mm.
struct SkinContourOptions {
  double frame_margin_mm = 0.4;  ///< border pixels nearer to the frame's edge are not skin
  double smoothing_mm = 0.4;     ///< sigma_c: rms distance of the border pixels from the spline
  int num_points = 512;          ///< at equal arc length
  double outline_mm = 0.2;    ///< the same as smoothing_mm, of the outline, which keeps the nipple
  double curvature_blur = 2;  ///< Gaussian over the curvature, in points
  double shortest_mm = 60;    ///< shorter contours are refused
  bool force = false;         ///< takes them all the same
  double nipple_knots_mm =
      2.5;  ///< distance of the knots of the finer curve that is searched for the nipple
  double nipple_blur_mm = 1.5;     ///< Gaussian over that curve's curvature
  double nipple_narrowest_mm = 3;  ///< width of its bump of curvature at half height
  double nipple_widest_mm = 15;
  double nipple_deviations = 4;    ///< robust standard deviations by which it stands out
  std::string name = "the image";  ///< for messages
};

/// The tip of the nipple on the skin line.
struct Nipple {
  Point<2> point = Point<2>::Zero();  ///< mm
  double t = 0;                       ///< share of the contour's length before it
  double deviations = 0;  ///< how far its curvature stands out, in robust standard deviations
};

/// The skin line of a breast from its upper to its lower end in the picture, smoothed.
struct SkinContour {
  Polyline points;  ///< at equal arc length, mm
  /// c(t) = kappa(t) L at the points, L the length: no unit, from the spline's derivatives, clipped to its 1 %
  /// and 99 % quantiles and blurred. Positive where the contour, walked downwards, turns from +x to +y.
  std::vector<double> curvature;
  double length_mm = 0;
  double rms_mm = 0;           ///< of the border pixels' distances from the spline
  int num_control_points = 0;  ///< of the spline
  std::optional<Nipple> nipple;
  /// The same line less smoothed, from the same upper to the same lower end: the contour may cut off a nipple.
  Polyline outline;
  /// The breast's border from the lower end along the frame back to the upper end, mm.
  Polyline rest;
};

/// Follows the border of the breast's mask, without what runs along the frame's edge: its longest run. Border
/// pixels lie inside the border, by half a pixel along an axis: the points are moved out on to it.
/// @param mask  one component.
/// @throws InvalidInput when the contour is shorter than `shortest_mm`.
SkinContour find_skin_contour(const Mask<2>& mask, const SkinContourOptions& options = {});

/// The same for points that follow a skin line already, in order, mm (without `rest`).
SkinContour smooth_contour(const Polyline& points, const SkinContourOptions& options = {});

/// The largest bump of outward curvature of the width of a nipple that stands out far enough; none: no such
/// bump. The nipple is sought on a finer spline than the contour's, in its middle nine tenths.
/// @param points  border pixels in order, mm.
std::optional<Nipple> find_nipple(const Polyline& points, const SkinContourOptions& options = {});

}  // namespace crease
