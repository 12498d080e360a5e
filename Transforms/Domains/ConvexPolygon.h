#pragma once

#include <span>
#include <vector>

#include "Transforms/Domains/Polygon.h"

namespace crease {

/// The part of a polygon on the left of the directed line from a to b (Sutherland-Hodgman). Exact for
/// convex polygons; of others the signed area is right, and edges may run along the line twice.
Polyline clipped_by_line(std::span<const Point<2>> polygon, const Point<2>& a, const Point<2>& b);

/// The part of a polygon inside a convex one given counter-clockwise.
Polyline clipped_by_convex(std::span<const Point<2>> polygon, std::span<const Point<2>> convex);

/// The parts of a convex polygon outside another one given counter-clockwise: convex, disjoint, together the
/// whole difference. Parts without area are left out.
std::vector<Polyline> convex_difference(std::span<const Point<2>> polygon,
                                        std::span<const Point<2>> convex);

/// The convex hull, counter-clockwise, without collinear corners. Points on one line give its two ends.
/// Source: Andrew, "Another efficient algorithm for convex hulls in two dimensions", IPL 9, 1979.
Polyline convex_hull(std::span<const Point<2>> points);

}  // namespace crease
