#pragma once

#include <functional>
#include <string>
#include <vector>

#include "Registration/Phantoms/BodyScene.h"
#include "Registration/Phantoms/Phantom.h"

namespace crease {

/// What makes up a phantom with rigid bodies.
struct RigidPhantomPlan {
  struct Mark {
    std::string name;
    Point<2> fixed;
    int body = -1;  ///< index of the body it moves with; -1: it stays
  };

  std::string kind;
  std::vector<RigidBody> bodies;
  std::vector<Point<2>> anchors;
  double spline_spacing_mm = 1;  ///< RigidBodiesMap
  double turn_share = 1;         ///< RigidBodiesMap
  double jitter_deg = 0;         ///< largest further turn of a body for seeds other than 1
  double jitter_mm = 0;          ///< largest further shift along each axis
  int outline_chords = 1;        ///< chords per rounded corner in the feature lines
  std::vector<Mark> marks;
  SceneStyle style;
  /// Discs of soft tissue between the moved bodies; may be null.
  std::function<std::vector<SoftDisc>(const std::vector<RigidBody>&)> discs;
  double default_noise = 0;
};

/// Draws the motions, makes the map and samples both images. Where a drawn motion would squeeze
/// tissue below a determinant of 0.2, the draw is halved until it does not.
/// @throws SolverError when the plan itself squeezes tissue that much.
Phantom make_rigid_phantom(const RigidPhantomPlan& plan, const PhantomOptions& options);

}  // namespace crease
