#include <cmath>
#include <numbers>

#include "Registration/Phantoms/RigidPhantom.h"

namespace crease {
namespace {

constexpr int kVertebrae = 5;
constexpr double kDegree = std::numbers::pi / 180;

// An intervertebral disc half-way between two moved vertebrae.
SoftDisc disc_between(const RigidBody& above, const RigidBody& below, double unit) {
  const Point<2> a = above.motion.map()(above.shape.center());
  const Point<2> b = below.motion.map()(below.shape.center());
  const Vector<2> axis = b - a;
  SoftDisc disc;
  disc.center = 0.5 * (a + b);
  disc.half_axes = {32 * unit, 16 * unit};
  disc.angle_rad = std::atan2(axis.y(), axis.x()) - 90 * kDegree;
  disc.edge_mm = 3 * unit;
  disc.grey = 0.5;
  return disc;
}

}  // namespace

// Experiment 3 of the dissertation, chapter 3, scaled from 512 mm
Phantom make_spine_phantom(const PhantomOptions& options) {
  const double unit = options.size / 512.0;
  RigidPhantomPlan plan;
  plan.kind = "spine";
  for (int i = 0; i < kVertebrae; ++i) {
    const Point<2> center(256 + 30 * std::sin(0.6 * i), 60 + 95 * i);
    const double tilt = -std::atan2(18 * std::cos(0.6 * i), 95.0);  // height along the tangent
    const double k = i - 2;
    plan.bodies.push_back(
        {RoundedPolygon::rectangle(unit * center, unit * Vector<2>(70, 42), 8 * unit, tilt),
         {3 * k * kDegree, unit * center, unit * Vector<2>(2 * k * k, 4 * k)},
         0.8});
    for (const auto& p : plan.bodies.back().shape.corner_points()) {
      plan.marks.push_back({"corner of vertebra " + std::to_string(i + 1), p, i});
    }
  }
  plan.spline_spacing_mm = 12 * unit;
  plan.jitter_deg = 1;
  plan.jitter_mm = 1.5 * unit;
  plan.outline_chords = 2;
  plan.style = {.background = 0.3, .background_texture = 0.08, .body_texture = 0.04, .discs = {}};
  plan.discs = [unit](const std::vector<RigidBody>& moved) {
    std::vector<SoftDisc> discs;
    for (std::size_t i = 0; i + 1 < moved.size(); ++i) {
      discs.push_back(disc_between(moved[i], moved[i + 1], unit));
    }
    return discs;
  };
  plan.default_noise = 0.01;
  return make_rigid_phantom(plan, options);
}

}  // namespace crease
