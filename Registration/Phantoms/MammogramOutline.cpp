#include "Registration/Phantoms/MammogramOutline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "Transforms/Domains/ArcLength.h"

namespace crease {
namespace {

const Point<2> kCenter(0, 0.52);
constexpr double kPectoralWidth = 0.26, kPectoralHeight = 0.42;

Point<2> pectoral_point(double x) { return {x, kPectoralHeight * (1 - x / kPectoralWidth)}; }

}  // namespace

double skin_radius(double theta) {
  constexpr double kPower = 2.2;
  const double ellipse = std::pow(std::pow(std::abs(std::cos(theta)) / 0.55, kPower) +
                                      std::pow(std::abs(std::sin(theta)) / 0.40, kPower),
                                  -1 / kPower);
  const double ripples = 1 + 0.015 * std::sin(3 * theta + 1) + 0.01 * std::sin(5 * theta);
  const double bump = (theta - kNippleAngle) / 0.045;
  return ellipse * ripples + 0.022 * std::exp(-bump * bump);
}

Point<2> skin_point(double theta) {
  return kCenter + skin_radius(theta) * Vector<2>(std::cos(theta), std::sin(theta));
}

double skin_depth(const Point<2>& x) {
  const Vector<2> d = x - kCenter;
  return skin_radius(std::atan2(d.y(), d.x())) - d.norm();
}

Polyline skin_line(double first_theta, double last_theta, int count) {
  Polyline points;
  for (int i = 0; i < count; ++i) {
    points.push_back(skin_point(first_theta + (last_theta - first_theta) * i / (count - 1)));
  }
  return points;
}

std::vector<double> skin_angles_by_length(int count) {
  constexpr int kSteps = 8192;
  const double first = -0.5 * std::numbers::pi, step = std::numbers::pi / kSteps;
  const Polyline points = skin_line(first, -first, kSteps + 1);
  const std::vector<double> lengths = arc_lengths(points);
  std::vector<double> angles;
  for (int k = 0; k < count; ++k) {
    const auto place = place_at_length(lengths, lengths.back() * k / (count - 1));
    angles.push_back(first + step * (static_cast<double>(place.first) + place.share));
  }
  return angles;
}

double breast_thickness(double depth) {
  const double rest = 1 - std::clamp(depth / 0.12, 0.0, 1.0);
  return std::sqrt(1 - rest * rest);
}

double pectoral_depth(const Point<2>& x) {
  return (1 - x.x() / kPectoralWidth - x.y() / kPectoralHeight) /
         std::hypot(1 / kPectoralWidth, 1 / kPectoralHeight);
}

Polyline pectoral_line(double first_x, int count) {
  double inside = 0, outside = kPectoralWidth;
  for (int i = 0; i < 60; ++i) {  // down to the last bit
    const double middle = 0.5 * (inside + outside);
    (skin_depth(pectoral_point(middle)) > 0 ? inside : outside) = middle;
  }
  Polyline points;
  for (int i = 0; i < count; ++i) {
    points.push_back(pectoral_point(first_x + (inside - first_x) * i / (count - 1)));
  }
  return points;
}

}  // namespace crease
