#pragma once

#include <vector>

#include "Registration/Phantoms/RoundedPolygon.h"
#include "Transforms/AffineMap.h"
#include "Transforms/SplineTransform.h"

namespace crease {

/// Turns by an angle about a centre, then shifts: x -> R (x - center) + center + shift.
struct RigidMotion {
  double angle_rad = 0;  ///< from the x to the y axis
  Point<2> center = Point<2>::Zero();
  Vector<2> shift = Vector<2>::Zero();

  AffineMap<2> map() const;
  AffineMap<2> inverse() const;
};

/// A rigid body: its outline in the fixed image and its motion to the moving image.
struct RigidBody {
  RoundedPolygon shape;
  RigidMotion motion;
  double grey = 0;  ///< intensity, 0 to 1
};

/// A map that is rigid in each of several bodies and smooth between them, with a crease along their
/// outlines:
///
///     T(x) = S(x) + f(d) (M_k(x) - S(x)),    f(d) = 1 for d <= 0, (1 - d/D)^2 up to D, then 0,
///
/// M_k the motion of the nearest body, d the distance to it, D half the smallest gap between bodies
/// and anchors; S the thin-plate spline through points of the outlines, which follow their bodies'
/// shifts and a share s of their turns, and through anchors, which stay. So T = M_k in body k to
/// the last bit and is continuous everywhere. For s = 1, S meets the bodies almost smoothly (the
/// plate of least bending has no kink at a rigid inclusion); for s < 1 the gradient jumps along the
/// outlines by up to 2 (1 - s) |turn| radius / D, a true crease.
class RigidBodiesMap {
 public:
  /// @param bodies  with gaps between them.
  /// @param anchors  further points that do not move, outside the bodies, mm.
  /// @param spacing  of the spline's points along the outlines, mm.
  /// @param turn_share  s, 0 to 1.
  RigidBodiesMap(std::vector<RigidBody> bodies, const std::vector<Point<2>>& anchors,
                 double spacing, double turn_share);

  const std::vector<RigidBody>& bodies() const { return bodies_; }
  /// Label of the body that holds x, 1 for the first; 0 outside.
  int label(const Point<2>& x) const;
  /// Label of the body whose moved outline holds y, a point of the moving image; 0 outside.
  int moving_label(const Point<2>& y) const;
  Point<2> operator()(const Point<2>& x) const;

 private:
  std::vector<RigidBody> bodies_;
  std::vector<AffineMap<2>> motions_;
  std::vector<AffineMap<2>> inverse_motions_;
  double reach_;  // D
  SplineTransform<2> background_;
};

}  // namespace crease
