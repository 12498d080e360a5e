#pragma once

#include <optional>

#include "Images/Image.h"
#include "Registration/Mammogram/PectoralMuscle.h"

// The two searches behind find_pectoral_muscle, for PectoralMuscle.cpp alone.
namespace crease::pectoral {

/// The film with the chest wall on the left, blurred, and where edges may lie. Points in pixels.
struct View {
  Image<float, 2> grey;    ///< 0 to 255 over the histogram's range
  Image<float, 2> gx, gy;  ///< its gradient, grey values per pixel
  Mask<2> breast;
  Mask<2> allowed;  ///< the breast away from the skin
  double pixel_mm = 1;
};

/// Whether the mask is set at the pixel nearest to a point of the view.
bool holds(const Mask<2>& mask, const Point<2>& p);
/// Bilinear; 0 outside.
double value_at(const Image<float, 2>& image, const Point<2>& p);

/// The line x cos(angle) + y sin(angle) = offset; the angle is also its slope against the chest wall.
struct StraightLine {
  double angle_rad = 0;
  double offset = 0;  ///< pixels

  Vector<2> normal() const;     ///< away from the corner
  Vector<2> direction() const;  ///< downwards, towards the chest wall
};

/// The line that most of Canny's edges in the upper quadrant at the chest wall lie on, counting edges that
/// are bright towards the corner and slope as a muscle may; none: too few.
/// Source: J. Canny, "A computational approach to edge detection", IEEE TPAMI 8(6), 1986; R. Duda and P. Hart,
/// "Use of the Hough transformation to detect lines and curves in pictures", CACM 15(1), 1972.
std::optional<StraightLine> best_straight_line(const View& view, const PectoralOptions& options);

/// The path within `search_mm` of the line whose integral of 1 / (1 + gradient towards the corner) is least, a
/// point per pixel, from `search_mm` beyond the line's end at the upper edge to as far beyond its end at the chest
/// wall; by dynamic programming.
Polyline cheapest_path(const View& view, const StraightLine& line, const PectoralOptions& options);

}  // namespace crease::pectoral
