#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "Core/Point.h"

namespace crease {

/// Corners of a polygon in order, the first not repeated, or points of an open polyline, in mm.
using Polyline = std::vector<Point<2>>;

/// Turns left by 90 degrees.
inline Vector<2> turned_left(const Vector<2>& v) { return {-v.y(), v.x()}; }
/// a x b = |a||b| sin(angle from a to b).
inline double cross(const Vector<2>& a, const Vector<2>& b) {
  return a.x() * b.y() - a.y() * b.x();
}
/// Angle from direction a to direction b, in (-pi, pi], left turns positive; 0 for zero vectors.
double turn_angle(const Vector<2>& a, const Vector<2>& b);

/// Area inside the polygon, mm^2: positive when its corners go counter-clockwise.
double signed_area(std::span<const Point<2>> polygon);
/// Total length; of a closed polyline with the edge from last to first.
double polyline_length(std::span<const Point<2>> points, bool closed);
/// How often the polygon winds counter-clockwise round p. Points on the polygon itself may go either way.
int winding_number(std::span<const Point<2>> polygon, const Point<2>& p);
/// Inside by the even-odd rule of the winding number (simple polygons: inside).
inline bool point_in_polygon(std::span<const Point<2>> polygon, const Point<2>& p) {
  return winding_number(polygon, p) % 2 != 0;
}

/// The point of segment ab closest to p.
Point<2> closest_point_on_segment(const Point<2>& p, const Point<2>& a, const Point<2>& b);
/// Distance from p to the polyline, mm; infinite for no points.
double distance_to_polyline(std::span<const Point<2>> points, bool closed, const Point<2>& p);

/// Where segments ab and cd meet in one point, touching ends included; parallel segments never do.
std::optional<Point<2>> segment_crossing(const Point<2>& a, const Point<2>& b, const Point<2>& c,
                                         const Point<2>& d);

/// Two edges of a polyline that meet although they are not neighbours, or neighbours that overlap.
/// Edge i runs from point i to the next one.
struct SelfIntersection {
  int first_edge = 0, second_edge = 0;
  Point<2> point = Point<2>::Zero();  ///< mm
};
/// The first such pair (lowest edge numbers), if any. O(n log n) for the usual polyline.
std::optional<SelfIntersection> find_self_intersection(std::span<const Point<2>> points,
                                                       bool closed);

/// Pairs (i, k), i < k, of boxes that intersect, sorted.
std::vector<std::pair<int, int>> intersecting_boxes(std::span<const Point<2>> lower,
                                                    std::span<const Point<2>> upper);

/// Fewest points so that none of those dropped is farther than `tolerance` (mm) from the result; kept points
/// are among the given ones, ends are kept.
/// Source: Douglas and Peucker, "Algorithms for the reduction of the number of points required to
/// represent a digitized line or its caricature", The Canadian Cartographer 10, 1973.
Polyline simplify_polyline(std::span<const Point<2>> points, bool closed, double tolerance);

/// `count` points at equal arc length: both ends of an open polyline (count >= 2), or starting at the
/// first point of a closed one.
Polyline resample_polyline(std::span<const Point<2>> points, bool closed, int count);

}  // namespace crease
