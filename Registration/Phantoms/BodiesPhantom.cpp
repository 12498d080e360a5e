#include <numbers>

#include "Registration/Phantoms/RigidPhantom.h"

namespace crease {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

}  // namespace

// Experiment 2 of the dissertation, chapter 3, in the domain [0, 8]^2
Phantom make_bodies_phantom(const PhantomOptions& options) {
  const double unit = options.size / 8.0;
  const auto at = [unit](double x, double y) { return Point<2>(unit * x - 0.5, unit * y - 0.5); };
  const auto body = [unit](Polyline corners, double turn_deg, const Vector<2>& shift, double grey) {
    const RoundedPolygon shape(std::move(corners));
    return RigidBody{shape, {turn_deg * kDegree, shape.center(), unit * shift}, grey / 255};
  };
  RigidPhantomPlan plan;
  plan.kind = "bodies";
  plan.bodies = {
      body({at(1, 5), at(3, 5), at(3, 7), at(1, 7)}, 12, {0.35, 0.15}, 200),
      body({at(3, 3), at(5, 1), at(7, 3), at(5, 5)}, -20, {0.25, -0.10}, 160),
      body({at(1, 1), at(3, 1), at(1, 3)}, 15, {0.30, 0.25}, 120),
  };
  plan.anchors = {at(0, 0), at(8, 0), at(8, 8), at(0, 8)};
  plan.spline_spacing_mm = unit / 4;
  plan.turn_share = 0.6;
  plan.jitter_deg = 2;
  plan.jitter_mm = options.size / 160.0;
  for (int k = 0; k < 3; ++k) {
    for (const auto& p : plan.bodies[k].shape.corner_points()) {
      plan.marks.push_back({std::string("corner of body ") + static_cast<char>('A' + k), p, k});
    }
  }
  plan.marks.push_back({"side of body C", at(2, 2), 2});
  plan.marks.push_back({"centre of body B", at(5, 3), 1});
  plan.style = {
      .background = 40 / 255.0, .background_texture = 0.05, .body_texture = 0.03, .discs = {}};
  return make_rigid_phantom(plan, options);
}

}  // namespace crease
