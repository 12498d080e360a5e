#pragma once

#include <functional>
#include <span>

#include "Transforms/Domains/Polygon.h"

namespace crease {

struct CurveSamplingOptions {
  double tolerance =
      0;  ///< mm; corners farther than this from the result are kept if there is room
  double max_turn_deg = 45;    ///< wanted bound of the turn from edge to edge of a smooth curve
  double smallest_edge = 0.4;  ///< of the edge length wanted: no edge is made shorter on purpose
  bool keep_area =
      false;  ///< moves vertices off the curve so that chords cut off as much as they add
};

struct SampledCurve {
  Polyline points;
  double largest_offset = 0;  ///< mm, of the given points from the result
  double largest_turn_deg = 0;
};

/// Replaces a polyline by one with edges of about the length wanted: long straight edges are divided evenly,
/// dense curves get fewer points, more where they turn (chord offset h^2 curvature / 8 <= tolerance);
/// corners between edges of at least half the wanted length stay where they are, and so do the ends.
///
/// @param edge_length  wanted length at a point, mm, positive.
SampledCurve sample_curve(std::span<const Point<2>> points, bool closed,
                          const std::function<double(const Point<2>&)>& edge_length,
                          const CurveSamplingOptions& options);

/// Whether more than half of the edges are much shorter than wanted: the points follow a curve and are no
/// corners to be kept.
bool is_dense(std::span<const Point<2>> points, bool closed,
              const std::function<double(const Point<2>&)>& edge_length);

/// Largest turn from edge to edge, degrees.
double largest_turn_deg(std::span<const Point<2>> points, bool closed);

/// Whether more than half of the turns exceed 30 degrees, as in outlines that follow pixels.
bool looks_like_pixel_stairs(std::span<const Point<2>> points, bool closed);

}  // namespace crease
