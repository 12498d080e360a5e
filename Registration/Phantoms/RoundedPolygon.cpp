#include "Registration/Phantoms/RoundedPolygon.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace crease {
namespace {

// Share of a Gaussian of deviation 1 below x.
double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

}  // namespace

RoundedPolygon::RoundedPolygon(Polyline core, double radius)
    : core_(std::move(core)), radius_(radius) {
  for (std::size_t i = 0; i < core_.size(); ++i) {
    const Vector<2> edge = core_[(i + 1) % core_.size()] - core_[i];
    normals_.push_back(-turned_left(edge).normalized());
  }
}

RoundedPolygon RoundedPolygon::rectangle(const Point<2>& center, const Vector<2>& size,
                                         double radius, double angle_rad) {
  const Eigen::Rotation2Dd turn(angle_rad);
  const Vector<2> half = 0.5 * size.array() - radius;
  Polyline core;
  for (const Vector<2>& sign : Polyline{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    core.push_back(center + turn * half.cwiseProduct(sign));
  }
  return RoundedPolygon(std::move(core), radius);
}

Point<2> RoundedPolygon::center() const {
  Point<2> sum = Point<2>::Zero();
  for (const auto& p : core_) sum += p;
  return sum / static_cast<double>(core_.size());
}

double RoundedPolygon::signed_distance(const Point<2>& x) const {
  double inside = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < core_.size(); ++i) {
    inside = std::max(inside, normals_[i].dot(x - core_[i]));
  }
  return (inside <= 0 ? inside : distance_to_polyline(core_, true, x)) - radius_;
}

double RoundedPolygon::coverage(const Point<2>& x, double blur_mm) const {
  if (radius_ > 0) return normal_cdf(-signed_distance(x) / blur_mm);
  double product = 1;
  for (std::size_t i = 0; i < core_.size(); ++i) {
    product *= normal_cdf(-normals_[i].dot(x - core_[i]) / blur_mm);
  }
  return product;
}

Polyline RoundedPolygon::outline(int chords, double max_piece) const {
  Polyline points;
  for (std::size_t i = 0; i < core_.size(); ++i) {
    const std::size_t before = (i + core_.size() - 1) % core_.size();
    const std::size_t next = (i + 1) % core_.size();
    if (radius_ > 0) {
      const double turn = turn_angle(normals_[before], normals_[i]);
      for (int k = 0; k < chords; ++k) {
        points.push_back(core_[i] +
                         radius_ * (Eigen::Rotation2Dd(turn * k / chords) * normals_[before]));
      }
    }
    const Point<2> start = core_[i] + radius_ * normals_[i];
    const Point<2> end = core_[next] + radius_ * normals_[i];
    const int pieces = std::max(1, static_cast<int>(std::ceil((end - start).norm() / max_piece)));
    for (int k = 0; k < pieces; ++k) points.push_back(start + (end - start) * k / pieces);
  }
  return points;
}

Polyline RoundedPolygon::corner_points() const {
  Polyline points;
  for (std::size_t i = 0; i < core_.size(); ++i) {
    const std::size_t before = (i + core_.size() - 1) % core_.size();
    points.push_back(core_[i] + radius_ * (normals_[before] + normals_[i]).normalized());
  }
  if (radius_ == 0) return core_;
  return points;
}

}  // namespace crease
