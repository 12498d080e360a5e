#pragma once

#include <string>
#include <vector>

#include "Transforms/Domains/FeatureLine.h"
#include "Transforms/Domains/RegionOfInterest.h"

namespace crease {

/// Two ends of a body at its chest wall: of the points of its outline within a fiftieth of its width from its
/// box's left or right side, that with more of the outline, the uppermost (least y) and the lowermost.
std::vector<Point<2>> chest_wall_ends(const RegionOfInterest& body);

/// Leaves out corners of a ring with an edge shorter than `shortest`, as long as all that are left out lie within
/// `tolerance` of the edges that are drawn instead, and unless the ring would cross itself: small edges make small
/// triangles, and those fold first. The corner that changes the area least goes first. All in mm.
/// Source: M. Visvalingam and J. Whyatt, Line generalisation by repeated elimination of points, The Cartographic
/// Journal 30, 1993 (the order), with a bound of the distance.
Polyline without_short_edges(const Polyline& ring, double shortest, double tolerance);

/// A line that cuts a region, as the outline of all that lies on one side of it: continued straight beyond both
/// ends, and closed round that side outside the box. Triangles there get the label.
/// @param line     open.
/// @param box      of the region.
/// @param towards  a point on the side that is meant.
/// @throws InvalidInput for fewer than two points.
FeatureLine outline_beyond(const Polyline& line, const Box<2>& box, const Point<2>& towards,
                           int label, const std::string& name);

}  // namespace crease
