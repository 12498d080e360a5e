#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "Transforms/Domains/Polygon.h"

// Polylines and curves measured along themselves, in the unit of their points.
namespace crease {

/// The length up to each point of an open polyline: 0 at the first, all of it at the last.
std::vector<double> arc_lengths(std::span<const Point<2>> points);

/// A place between two neighbours of a list.
struct PlaceBetween {
  std::size_t first = 0;  ///< the earlier one
  double share = 0;       ///< 0 there, 1 at the next
};
/// Where a length lies among at least two that do not descend; those beyond the ends belong to the ends.
PlaceBetween place_at_length(std::span<const double> lengths, double length);

/// The point of a polyline that has a length before it. @param lengths  its arc_lengths().
Point<2> point_at_length(std::span<const Point<2>> points, std::span<const double> lengths,
                         double length);

/// The place of a polyline that is nearest to a point.
struct NearestPlace {
  double distance = std::numeric_limits<double>::infinity();  ///< of the point from the place
  double length = 0;                                          ///< of the polyline up to the place
  Point<2> point = Point<2>::Zero();
};
/// The first of them if there are several. Without an edge the distance is infinite.
NearestPlace nearest_place(std::span<const Point<2>> points, bool closed, const Point<2>& p);

}  // namespace crease
