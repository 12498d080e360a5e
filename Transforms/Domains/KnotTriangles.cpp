#include "Transforms/Domains/KnotTriangles.h"

#include <algorithm>
#include <limits>

#include "Transforms/Domains/ConvexPolygon.h"

namespace crease {
namespace {

const Point<2>& knot(std::span<const Point<2>> cloud, int index) {
  return cloud[static_cast<std::size_t>(index) < cloud.size() ? index : 0];
}

}  // namespace

double smallest_knot_triangle(const TriangleClouds& clouds, int degree) {
  const auto content = [&](int i, int j, int k) {
    const Point<2>& a = knot(clouds[0], i);
    return cross(knot(clouds[1], j) - a, knot(clouds[2], k) - a);
  };
  const double whole = content(0, 0, 0);
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= degree; ++i) {
    for (int j = 0; i + j <= degree; ++j) {
      for (int k = 0; i + j + k <= degree; ++k) smallest = std::min(smallest, content(i, j, k));
    }
  }
  return smallest / whole;
}

double core_share(const TriangleClouds& clouds, int degree) {
  Polyline core{clouds[0][0], clouds[1][0], clouds[2][0]};
  const double whole = signed_area(core);
  for (int a = 0; a < 3; ++a) {
    const auto &from = clouds[a], &to = clouds[(a + 1) % 3];
    for (int i = 0; i <= degree; ++i) {
      for (int j = 0; i + j <= degree; ++j) {
        core = clipped_by_line(core, knot(from, i), knot(to, j));
      }
    }
  }
  return core.size() < 3 ? 0 : signed_area(core) / whole;
}

bool has_core(const TriangleClouds& clouds, int degree) {
  const Point<2>&a = clouds[0][0], &b = clouds[1][0], &c = clouds[2][0];
  const double ab = (b - a).norm(), bc = (c - b).norm(), ca = (a - c).norm();
  const double perimeter = ab + bc + ca;
  const Point<2> incentre = (bc * a + ca * b + ab * c) / perimeter;
  const double inradius = cross(b - a, c - a) / perimeter;
  bool inside = true;
  for (int e = 0; e < 3 && inside; ++e) {
    const auto &from = clouds[e], &to = clouds[(e + 1) % 3];
    for (int i = 0; i <= degree; ++i) {
      for (int j = 0; i + j <= degree; ++j) {
        const Vector<2> side = knot(to, j) - knot(from, i);
        inside = inside && cross(side, incentre - knot(from, i)) > 1e-3 * inradius * side.norm();
      }
    }
  }
  return inside || core_share(clouds, degree) > 1e-6;
}

}  // namespace crease
