#pragma once

#include <span>

#include "Transforms/Domains/Polygon.h"
#include "Transforms/Splines/KnotPlanes.h"

namespace crease {

/// A convex polygon, counter-clockwise.
using KnotPolygon = Polyline;

/// Area, centroid and covariance (second moments about the centroid by area) of a convex polygon.
struct PolygonMoments {
  double area = 0.0;
  Point<2> centroid = Point<2>::Zero();
  Matrix<2> covariance = Matrix<2>::Zero();
};
PolygonMoments polygon_moments(std::span<const Point<2>> polygon);

/// The part of a convex polygon with normal . u >= offset.
KnotPolygon clip(const KnotPolygon& polygon, const KnotPlane<2>& side);

/// Whether u lies in a convex polygon or within `tie` of it.
bool polygon_contains(const KnotPolygon& polygon, const Point<2>& u, double tie);

/// The line from a to b with the polygon's inner side (the left) positive.
KnotPlane<2> side_through(const Point<2>& a, const Point<2>& b);

}  // namespace crease
