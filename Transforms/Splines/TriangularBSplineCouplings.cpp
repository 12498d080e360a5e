#include <algorithm>

#include "Core/Parallel.h"
#include "Transforms/Domains/ConvexPolygon.h"
#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/TriangularBSplineQuadrature.h"

namespace crease {
namespace {

struct Support {
  KnotPolygon hull;
  std::vector<KnotPlane<2>> sides;
  Box<2> box;

  // Whether all of another hull lies beyond one of the sides, or deeper inside by no more than `depth`.
  bool beside(const KnotPolygon& other, double depth) const {
    for (const auto& side : sides) {
      if (std::all_of(other.begin(), other.end(),
                      [&](const Point<2>& p) { return side.distance(p) <= depth; })) {
        return true;
      }
    }
    return false;
  }
};

bool overlap(const Support& a, const Support& b, double touching) {
  return a.hull.size() > 2 && b.hull.size() > 2 && !a.beside(b.hull, touching) &&
         !b.beside(a.hull, touching);
}

// Supports of a triangle's functions, and the box of all of them.
struct TriangleSupports {
  std::vector<Support> functions;
  Box<2> box;
};

TriangleSupports supports_of(const KnotNet<2>& net, int triangle) {
  TriangleSupports result;
  for (const auto& beta : multi_indices<2>(net.degree)) {
    std::vector<Point<2>> knots;
    for (int j = 0; j < 3; ++j) {
      const auto& cloud = net.clouds[net.mesh.simplices[triangle][j]];
      for (int k = 0; k <= beta[j]; ++k) {
        if (k < static_cast<int>(cloud.size())) knots.push_back(cloud[k]);
      }
    }
    Support support{convex_hull(knots), {}, bounding_box<2>(knots)};
    for (std::size_t i = 0; i < support.hull.size(); ++i) {
      const auto& next = support.hull[(i + 1) % support.hull.size()];
      support.sides.push_back(side_through(support.hull[i], next));
    }
    result.box.add(support.box.lower);
    result.box.add(support.box.upper);
    result.functions.push_back(std::move(support));
  }
  return result;
}

}  // namespace

std::vector<std::pair<int, int>> overlapping_functions(const KnotNet<2>& net,
                                                       const KnotControlPoints<2>& control_points) {
  const auto count = std::ssize(net.mesh.simplices);
  const auto neighbours = vertex_neighbours(net.mesh);
  const double touching = 1e-13 * mesh_scale(net.mesh);
  std::vector<TriangleSupports> supports(count);
  parallel_for(count, [&](std::int64_t t) { supports[t] = supports_of(net, static_cast<int>(t)); });

  // Functions of one triangle all meet in its core; known[i]: the partners of i by that.
  std::vector<std::vector<int>> known(control_points.count());
  for (std::int64_t t = 0; t < count; ++t) {
    const auto points = control_points.of_simplex(static_cast<int>(t));
    for (int i : points) known[i].insert(known[i].end(), points.begin(), points.end());
  }
  for (auto& partners : known) {
    std::sort(partners.begin(), partners.end());
    partners.erase(std::unique(partners.begin(), partners.end()), partners.end());
  }

  std::vector<std::vector<std::pair<int, int>>> found(count);
  parallel_for(count, [&](std::int64_t t) {
    std::vector<int> others;  // clouds overhang, so look two triangles far
    for (int n : neighbours[t]) {
      for (int o : neighbours[n]) {
        if (o > t) others.push_back(o);
      }
    }
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    const auto own = control_points.of_simplex(static_cast<int>(t));
    for (int o : others) {
      if (!supports[t].box.intersects(supports[o].box)) continue;
      const auto theirs = control_points.of_simplex(o);
      for (std::size_t a = 0; a < own.size(); ++a) {
        const Support& s = supports[t].functions[a];
        if (!s.box.intersects(supports[o].box)) continue;
        for (std::size_t b = 0; b < theirs.size(); ++b) {
          const Support& r = supports[o].functions[b];
          if (!s.box.intersects(r.box)) continue;
          if (std::binary_search(known[own[a]].begin(), known[own[a]].end(), theirs[b])) continue;
          if (overlap(s, r, touching)) {
            found[t].push_back(std::minmax(own[a], theirs[b]));
          }
        }
      }
    }
  });

  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < control_points.count(); ++i) {
    for (int k : known[i]) {
      if (i <= k) pairs.push_back({i, k});
    }
  }
  for (const auto& more : found) pairs.insert(pairs.end(), more.begin(), more.end());
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace crease
