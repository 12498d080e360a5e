#include <numbers>

#include "Registration/Phantoms/RigidPhantom.h"

namespace crease {

// Experiment 1 of the dissertation, chapter 3, in the domain [0, 6]^2
Phantom make_square_phantom(const PhantomOptions& options) {
  const double unit = options.size / 6.0;
  const auto at = [unit](double x, double y) { return Point<2>(unit * x - 0.5, unit * y - 0.5); };
  RigidPhantomPlan plan;
  plan.kind = "square";
  plan.bodies = {{RoundedPolygon({at(3, 1), at(5, 3), at(3, 5), at(1, 3)}),
                  {std::numbers::pi / 4, at(3, 3), {0, 0}},
                  0.8}};
  plan.anchors = {at(0, 0), at(6, 0), at(6, 6), at(0, 6)};
  plan.spline_spacing_mm = unit / 4;
  plan.turn_share = 0.8;
  plan.jitter_deg = 4;
  for (const auto& p : plan.anchors) plan.marks.push_back({"corner of the domain", p});
  for (const auto& p : plan.bodies[0].shape.corner_points()) {
    plan.marks.push_back({"corner of the square", p, 0});
  }
  plan.style = {.background = 0.2, .background_texture = 0.05, .body_texture = 0.03, .discs = {}};
  return make_rigid_phantom(plan, options);
}

}  // namespace crease
