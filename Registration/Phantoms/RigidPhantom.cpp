#include "Registration/Phantoms/RigidPhantom.h"

#include <limits>
#include <memory>
#include <numbers>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Registration/Phantoms/PhantomParts.h"

namespace crease {
namespace {

constexpr double kSmallestDeterminant = 0.2;

// The plan's motions, each moved further by the draws times `scale`.
std::vector<RigidBody> jittered(const RigidPhantomPlan& plan, const PhantomOptions& options,
                                double scale) {
  std::vector<RigidBody> bodies = plan.bodies;
  if (options.seed == PhantomOptions{}.seed) return bodies;
  Random random = random_stream(options, Stream::kMotion);
  for (auto& body : bodies) {
    const double turn_deg = plan.jitter_deg * random.uniform(-1, 1);
    body.motion.angle_rad += scale * turn_deg * std::numbers::pi / 180;
    for (double& s : body.motion.shift) s += scale * plan.jitter_mm * random.uniform(-1, 1);
  }
  return bodies;
}

void add_labels(Phantom& phantom, const RigidBodiesMap& map) {
  const Raster<2>& raster = phantom.displacement.raster();
  phantom.labels = phantom.moving_labels = LabelImage<2>(raster);
  parallel_for(raster.size[1], [&](std::int64_t row) {
    const int j = static_cast<int>(row);
    for (int i = 0; i < raster.size[0]; ++i) {
      const Point<2> x = raster.point({double(i), double(j)});
      phantom.labels(i, j) = map.label(x);
      phantom.moving_labels(i, j) = map.moving_label(x);
    }
  });
}

void add_outlines(Phantom& phantom, const RigidPhantomPlan& plan) {
  for (std::size_t k = 0; k < plan.bodies.size(); ++k) {
    FeatureLine line;
    line.points =
        plan.bodies[k].shape.outline(plan.outline_chords, std::numeric_limits<double>::infinity());
    line.closed = true;
    line.body = BodySide::kLeft;
    line.left_label = static_cast<int>(k) + 1;
    line.name = message("body ", k + 1);
    phantom.feature_lines.push_back(std::move(line));
  }
}

void add_landmarks(Phantom& phantom, const RigidPhantomPlan& plan,
                   const std::vector<RigidBody>& bodies, const PhantomOptions& options) {
  Random random = random_stream(options, Stream::kLandmarks);
  const double noise = options.landmark_noise_mm;
  for (const auto& mark : plan.marks) {
    Point<2> moving = mark.fixed;
    if (mark.body >= 0) moving = bodies[mark.body].motion.map()(mark.fixed);
    if (noise > 0) {
      for (double& x : moving) x += noise * random.normal();
      phantom.landmarks.sigma_mm.push_back(noise);
    }
    phantom.landmarks.fixed.push_back(mark.fixed);
    phantom.landmarks.moving.push_back(moving);
    phantom.landmarks.names.push_back(mark.name);
  }
}

void add_motions(Phantom& phantom, const std::vector<RigidBody>& bodies) {
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const RigidMotion& motion = bodies[k].motion;
    phantom.bodies.push_back({static_cast<int>(k) + 1, motion.angle_rad * 180 / std::numbers::pi,
                              motion.center, motion.shift});
  }
}

}  // namespace

Phantom make_rigid_phantom(const RigidPhantomPlan& plan, const PhantomOptions& options) {
  Phantom phantom;
  phantom.kind = plan.kind;
  std::shared_ptr<const RigidBodiesMap> map;
  std::pair<double, double> determinants;
  constexpr int kHalvings = 6;
  double scale = 1;
  for (int k = 0; k <= kHalvings; ++k, scale /= 2) {
    map = std::make_shared<RigidBodiesMap>(jittered(plan, options, scale), plan.anchors,
                                           plan.spline_spacing_mm, plan.turn_share);
    phantom.truth = [map](const Point<2>& x) { return (*map)(x); };
    phantom.displacement = displacement_of(phantom_raster<2>(options.size), phantom.truth);
    determinants = determinant_range(phantom.displacement);
    if (determinants.first >= kSmallestDeterminant) break;
  }
  if (determinants.first < kSmallestDeterminant) {
    throw SolverError(message("phantom ", plan.kind,
                              ": the map squeezes tissue to a determinant of ", determinants.first,
                              " at size ", options.size));
  }
  SceneStyle style = plan.style;
  if (plan.discs) style.discs = plan.discs(map->bodies());
  const double noise = options.noise.value_or(plan.default_noise);
  sample_images<2>(phantom, BodyScene(map->bodies(), style, make_texture<2>(options)), noise,
                   options);
  add_labels(phantom, *map);
  add_outlines(phantom, plan);
  add_landmarks(phantom, plan, map->bodies(), options);
  add_motions(phantom, map->bodies());
  phantom.parameters = {{"noise", noise},
                        {"landmark_noise_mm", options.landmark_noise_mm},
                        {"determinant_min", determinants.first},
                        {"determinant_max", determinants.second}};
  return phantom;
}

}  // namespace crease
