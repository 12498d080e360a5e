#pragma once

#include <cmath>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "Testing/Transforms/Domains/SampleDomains.h"
#include "Transforms/Domains/Mesher.h"

namespace crease::testing {

/// The frame of the theory's figures: a square of half-width 2.2 around 0.
inline constexpr double kHalfWidth = 2.2;

inline DomainMesh domain_with(const std::vector<FeatureLine>& lines, double edge_length = 0.9,
                              double edge_near_lines = 0.45) {
  return mesh_domain(rectangle(-kHalfWidth, -kHalfWidth, kHalfWidth, kHalfWidth), lines,
                     {.edge_length = edge_length, .edge_length_near_lines = edge_near_lines});
}

/// A disc of radius 1, its outline a regular polygon; 16 corners give edges of 0.39.
inline DomainMesh disc_domain(int corners, BodySide body = BodySide::kAutomatic) {
  return domain_with({closed_line(regular_polygon({0, 0}, 1, corners), body)}, 0.5,
                     2 * std::sin(std::numbers::pi / corners));
}

inline Polyline curve(double from, double to, int count, Point<2> (*at)(double)) {
  Polyline points;
  for (int k = 0; k <= count; ++k) points.push_back(at(from + (to - from) * k / count));
  return points;
}

/// y = c(x), from border to border.
inline double wave_height(double x) { return 0.25 * std::sin(1.7 * x); }
inline FeatureLine wavy_line() {
  return open_line(
      curve(-kHalfWidth, kHalfWidth, 120, [](double x) { return Point<2>(x, wave_height(x)); }));
}

/// Three spiral arms that leave the origin at 120 degrees and run to the border.
inline constexpr double kSpiral = 0.35;  // radians per unit of radius
inline std::vector<FeatureLine> spiral_junction() {
  std::vector<FeatureLine> lines;
  for (int arm = 0; arm < 3; ++arm) {
    Polyline points;
    for (int k = 0; k <= 100; ++k) {
      const double r = 3.2 * k / 100, angle = 2 * std::numbers::pi / 3 * arm + kSpiral * r;
      points.emplace_back(r * std::cos(angle), r * std::sin(angle));
    }
    lines.push_back(open_line(points));
  }
  return lines;
}

/// An arc of the circle of radius 1 around (0, -0.5) that ends inside the domain on both sides.
inline FeatureLine inner_arc() {
  return open_line(
      curve(0.3, 2.6, 60, [](double t) { return Point<2>(std::cos(t), std::sin(t) - 0.5); }));
}

struct CreasedDomain {
  std::string name;
  DomainMesh mesh;
};
inline void PrintTo(const CreasedDomain& domain, std::ostream* stream) { *stream << domain.name; }

/// Every kind of crease: outlines with and without a body, convex and concave, corners blunt and sharp,
/// lines that meet the border, end inside, meet each other and cross; coarse.
inline std::vector<CreasedDomain> creased_domains() {
  const auto disc = regular_polygon({0, 0}, 1, 12);
  Polyline bean;
  for (int k = 0; k < 24; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.3) / 24, r = 1 + 0.25 * std::cos(3 * angle);
    bean.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  const Polyline box = {{-1.1, -0.8}, {0.9, -0.9}, {1.0, 0.9}, {-0.9, 0.8}};
  auto sharp_box = closed_line(box);
  sharp_box.corner = CornerRule::kCollapse;
  const auto across = open_line(
      curve(-1.6, 1.6, 60, [](double y) { return Point<2>(0.3 * std::cos(1.3 * y), y); }));
  return {{"disc", domain_with({closed_line(disc)})},
          {"disc without body", domain_with({closed_line(disc, BodySide::kNone)})},
          {"body outside", domain_with({closed_line(disc, BodySide::kRight)})},
          {"bean", domain_with({closed_line(bean)})},
          {"blunt box", domain_with({closed_line(box)})},
          {"sharp box", domain_with({sharp_box})},
          {"wavy line", domain_with({wavy_line()})},
          {"inner arc", domain_with({inner_arc()})},
          {"junction", domain_with(spiral_junction())},
          {"crossing", domain_with({wavy_line(), across})}};
}

}  // namespace crease::testing
