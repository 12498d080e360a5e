#include "Registration/Phantoms/RigidBodiesMap.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "Transforms/LandmarkFits.h"

namespace crease {
namespace {

constexpr int kChords = 4;  // per rounded corner, for the spline's points

// Between bodies, and from bodies to anchors, mm.
double smallest_gap(const std::vector<RigidBody>& bodies, const std::vector<Point<2>>& anchors,
                    double spacing) {
  double gap = std::numeric_limits<double>::infinity();
  for (const auto& body : bodies) {
    for (const auto& p : anchors) gap = std::min(gap, body.shape.signed_distance(p));
    for (const auto& other : bodies) {
      if (&other == &body) continue;
      for (const auto& p : other.shape.outline(kChords, 0.1 * spacing)) {
        gap = std::min(gap, body.shape.signed_distance(p));
      }
    }
  }
  return gap;
}

SplineTransform<2> background(const std::vector<RigidBody>& bodies,
                              const std::vector<Point<2>>& anchors, double spacing,
                              double turn_share) {
  std::vector<Point<2>> from = anchors, to = anchors;
  for (const auto& body : bodies) {
    RigidMotion followed = body.motion;
    followed.angle_rad *= turn_share;
    const AffineMap<2> motion = followed.map();
    for (const auto& p : body.shape.outline(kChords, spacing)) {
      from.push_back(p);
      to.push_back(motion(p));
    }
  }
  return fit_thin_plate<2>(from, to);
}

}  // namespace

AffineMap<2> RigidMotion::map() const {
  AffineMap<2> result;
  result.linear = Eigen::Rotation2Dd(angle_rad).toRotationMatrix();
  result.offset = center + shift - result.linear * center;
  return result;
}

AffineMap<2> RigidMotion::inverse() const {
  const AffineMap<2> forward = map();
  AffineMap<2> result;
  result.linear = forward.linear.transpose();
  result.offset = -(result.linear * forward.offset);
  return result;
}

RigidBodiesMap::RigidBodiesMap(std::vector<RigidBody> bodies, const std::vector<Point<2>>& anchors,
                               double spacing, double turn_share)
    : bodies_(std::move(bodies)),
      reach_(0.5 * smallest_gap(bodies_, anchors, spacing)),
      background_(background(bodies_, anchors, spacing, turn_share)) {
  for (const auto& body : bodies_) {
    motions_.push_back(body.motion.map());
    inverse_motions_.push_back(body.motion.inverse());
  }
}

int RigidBodiesMap::label(const Point<2>& x) const {
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (bodies_[k].shape.signed_distance(x) <= 0) return static_cast<int>(k) + 1;
  }
  return 0;
}

int RigidBodiesMap::moving_label(const Point<2>& y) const {
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (bodies_[k].shape.signed_distance(inverse_motions_[k](y)) <= 0) {
      return static_cast<int>(k) + 1;
    }
  }
  return 0;
}

Point<2> RigidBodiesMap::operator()(const Point<2>& x) const {
  std::size_t nearest = 0;
  double distance = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const double d = bodies_[k].shape.signed_distance(x);
    if (d <= 0) return motions_[k](x);
    if (d < distance) {
      distance = d;
      nearest = k;
    }
  }
  Point<2> soft = background_.map(x);
  if (distance >= reach_) return soft;
  const double share = 1 - distance / reach_;
  return soft + share * share * (motions_[nearest](x) - soft);
}

}  // namespace crease
