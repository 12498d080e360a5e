#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <set>
#include <vector>

#include "Registration/Elastic/LoadSteps.h"
#include "Testing/Transforms/Domains/SampleDomains.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Domains/Mesher.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease::testing {

/// Half an ellipse of 70 x 95 mm, flat side at x = 0, with a line that cuts its upper corner off.
inline DomainMesh half_ellipse(double edge_length, bool with_line = true) {
  Polyline ring;
  constexpr int kCorners = 40;
  for (int k = 0; k <= kCorners; ++k) {
    const double angle = std::numbers::pi * (k / double(kCorners) - 0.5);
    ring.emplace_back(70 * std::cos(angle), 47.5 * std::sin(angle));
  }
  std::vector<FeatureLine> lines;
  if (with_line) lines.push_back(open_line({{0, 10}, {15, 27}, {26.8, 44}}));
  MeshOptions options;
  options.edge_length = edge_length;
  DomainMesh domain = mesh_domain(RegionOfInterest({ring}), lines, options);
  auto& mesh = domain.mesh;
  mesh.regions.assign(mesh.simplices.size(), 0);
  for (std::size_t t = 0; with_line && t < mesh.simplices.size(); ++t) {
    const auto& s = mesh.simplices[t];
    const Point<2> c = (mesh.vertices[s[0]] + mesh.vertices[s[1]] + mesh.vertices[s[2]]) / 3;
    const double line = c.x() < 15 ? 10 + c.x() * 17 / 15 : 27 + (c.x() - 15) * 17 / 11.8;
    if (c.y() > line) mesh.regions[t] = 1;
  }
  return domain;
}

/// A smooth motion of a few mm.
inline Vector<2> smooth_motion(const Point<2>& p, double size = 1) {
  return size * Vector<2>(3 * std::sin(p.y() / 30) + 0.04 * p.x(),
                          2 * std::cos(p.x() / 40) - 2 + 0.03 * p.y());
}

/// Pairs round the half ellipse, and some inside.
inline Landmarks<2> motion_pairs(int count, double size = 1) {
  Landmarks<2> pairs;
  for (int k = 0; k < count; ++k) {
    const double angle = std::numbers::pi * ((k + 0.5) / count - 0.5);
    pairs.fixed.emplace_back(69 * std::cos(angle), 46.8 * std::sin(angle));
  }
  for (const Point<2>& p : {Point<2>(20, 0), Point<2>(40, 12), Point<2>(35, -18)}) {
    pairs.fixed.push_back(p);
  }
  for (const auto& p : pairs.fixed) pairs.moving.emplace_back(p + smooth_motion(p, size));
  return pairs;
}

inline std::shared_ptr<const TriangularBSplineBasis<2>> spline_on(const DomainMesh& domain,
                                                                  const KnotOptions& options) {
  return std::make_shared<const TriangularBSplineBasis<2>>(place_knots(domain, options).net);
}

/// The half ellipse with a stiff corner, moderately loaded.
inline ElasticDeformation moderate_load(double edge_length = 14, double size = 1) {
  ElasticDeformation deformation;
  deformation.basis = spline_on(half_ellipse(edge_length), {.degree = 2});
  deformation.material.tissue = {.young = 1, .poisson = 0.3};
  deformation.material.regions[1] = {.young = 10, .poisson = 0.3};
  deformation.pairs = motion_pairs(14, size);
  return deformation;
}

/// Holds control points that act on chosen points of the border, at values given by a map.
inline LinearConstraints held_control_points(const SplineBasis<2>& basis,
                                             const std::vector<Point<2>>& points,
                                             const ControlPoints<2>& values) {
  std::set<int> held;
  for (const auto& p : points) {
    const auto found = basis.evaluate(p);
    for (std::size_t i = 0; i < found.control_points.size(); ++i) {
      if (std::abs(found.values[i]) > 1e-12) held.insert(found.control_points[i]);
    }
  }
  LinearConstraints constraints;
  constraints.C.resize(std::ssize(held), basis.num_control_points());
  constraints.d.resize(std::ssize(held), 2);
  int row = 0;
  for (int i : held) {
    constraints.C.insert(row, i) = 1;
    constraints.d.row(row++) = values.col(i).transpose();
  }
  return constraints;
}

/// Points along a segment.
inline std::vector<Point<2>> along(const Point<2>& a, const Point<2>& b, int count) {
  std::vector<Point<2>> points;
  for (int k = 0; k <= count; ++k) points.emplace_back(a + (b - a) * k / count);
  return points;
}

}  // namespace crease::testing
