#pragma once

#include "Transforms/AffineMap.h"
#include "Transforms/Domains/Polygon.h"

namespace crease {

/// All points within `radius` of a convex polygon: the outline of a phantom's rigid body. With
/// radius 0 the polygon itself, with its sharp corners.
class RoundedPolygon {
 public:
  /// @param core  corners in mm, convex, counter-clockwise.
  explicit RoundedPolygon(Polyline core, double radius = 0);
  /// A rectangle of the given full size, its corners rounded, turned about its centre.
  static RoundedPolygon rectangle(const Point<2>& center, const Vector<2>& size, double radius,
                                  double angle_rad);

  const Polyline& core() const { return core_; }
  double radius() const { return radius_; }
  /// Mean of the core's corners, mm.
  Point<2> center() const;
  /// Distance to the outline in mm, negative inside.
  double signed_distance(const Point<2>& x) const;
  /// The body's indicator function blurred by a Gaussian of deviation `blur_mm` (exactly so along
  /// straight edges and at sharp right-angled corners): smooth, 1 deep inside, 1/2 on edges, 0 far
  /// outside.
  double coverage(const Point<2>& x, double blur_mm) const;
  /// Points on the outline, counter-clockwise, first not repeated: every rounded corner as `chords`
  /// chords, every straight side cut into equal pieces no longer than `max_piece` mm.
  Polyline outline(int chords, double max_piece) const;
  /// One point per corner: the corner itself, or the middle of its arc.
  Polyline corner_points() const;

 private:
  Polyline core_;
  double radius_;
  Polyline normals_;  // outward unit normal of the edge from corner i to the next
};

}  // namespace crease
