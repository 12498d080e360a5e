#pragma once

#include <memory>
#include <vector>

#include "Registration/Phantoms/PowerLawTexture.h"
#include "Registration/Phantoms/RigidBodiesMap.h"

namespace crease {

/// A disc of soft tissue in the moving image: an ellipse with a soft edge.
struct SoftDisc {
  Point<2> center = Point<2>::Zero();       ///< mm
  Vector<2> half_axes = Vector<2>::Ones();  ///< mm
  double angle_rad = 0;                     ///< of the first half-axis, from the x to the y axis
  double edge_mm = 1;                       ///< deviation of the edge's blur
  double grey = 0;
};

/// Intensities of everything that is not a rigid body, and how strongly texture shows.
struct SceneStyle {
  double background = 0;
  double background_texture = 0;  ///< deviation of the texture outside bodies
  double body_texture = 0;        ///< deviation of the texture inside bodies
  double blur_mm = 1.2;           ///< deviation of the blur of the bodies' edges
  std::vector<SoftDisc> discs;
};

/// The moving image of a phantom with rigid bodies as an analytic function: background, discs and
/// bodies (at their moved places) over each other, with one texture over everything.
class BodyScene {
 public:
  /// @param texture  null: none.
  BodyScene(const std::vector<RigidBody>& bodies, SceneStyle style,
            std::shared_ptr<const PowerLawTexture<2>> texture);

  /// Intensity at a point of the moving image, mm.
  double operator()(const Point<2>& y) const;

 private:
  std::vector<RigidBody> bodies_;
  std::vector<AffineMap<2>> to_fixed_;  // inverse motion per body
  SceneStyle style_;
  std::shared_ptr<const PowerLawTexture<2>> texture_;
};

}  // namespace crease
