#include "Transforms/Splines/KnotBorder.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <map>

#include "Core/Error.h"
#include "Transforms/Domains/Polygon.h"

namespace crease {
namespace {

Point<3> closest_on_triangle(const Point<3>& x, const Point<3>& a, const Point<3>& b,
                             const Point<3>& c) {
  const auto on_edge = [&](const Point<3>& p, const Point<3>& q) -> Point<3> {
    const Vector<3> d = q - p;
    return p + std::clamp((x - p).dot(d) / d.squaredNorm(), 0.0, 1.0) * d;
  };
  const Vector<3> normal = (b - a).cross(c - a);
  const auto left_of = [&](const Point<3>& p, const Point<3>& q) {
    return normal.dot((q - p).cross(x - p)) >= 0.0;
  };
  if (left_of(a, b) && left_of(b, c) && left_of(c, a)) {
    return x - (x - a).dot(normal) / normal.squaredNorm() * normal;
  }
  Point<3> best = on_edge(a, b);
  for (const Point<3>& candidate : {on_edge(b, c), on_edge(c, a)}) {
    if ((candidate - x).squaredNorm() < (best - x).squaredNorm()) best = candidate;
  }
  return best;
}

}  // namespace

template <int Dim>
std::vector<std::array<int, Dim>> border_facets(const SimplexMesh<Dim>& mesh) {
  struct Entry {
    int simplices = 0;
    std::array<int, Dim> facet{};
  };
  std::map<std::array<int, Dim>, Entry> facets;
  for (const auto& simplex : mesh.simplices) {
    for (int d = 0; d <= Dim; ++d) {
      std::array<int, Dim> facet{};
      for (int j = 0, k = 0; j <= Dim; ++j) {
        if (j != d) facet[k++] = simplex[j];
      }
      auto key = facet;
      std::sort(key.begin(), key.end());
      Entry& entry = facets[key];
      entry.facet = facet;
      if (++entry.simplices > 2) {
        throw InvalidInput(message("mesh: more than two simplices share the facet with vertices ",
                                   key[0], " and ", key[1], "."));
      }
    }
  }
  std::vector<std::array<int, Dim>> border;
  for (const auto& [key, entry] : facets) {
    if (entry.simplices == 1) border.push_back(entry.facet);
  }
  return border;
}

template <int Dim>
Point<Dim> nearest_on_facets(const SimplexMesh<Dim>& mesh,
                             const std::vector<std::array<int, Dim>>& facets, const Point<Dim>& x) {
  Point<Dim> best = x;
  double distance = std::numeric_limits<double>::infinity();
  for (const auto& f : facets) {
    Point<Dim> candidate;
    if constexpr (Dim == 2) {
      candidate = closest_point_on_segment(x, mesh.vertices[f[0]], mesh.vertices[f[1]]);
    } else {
      candidate =
          closest_on_triangle(x, mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]]);
    }
    const double d = (candidate - x).squaredNorm();
    if (d < distance) {
      distance = d;
      best = candidate;
    }
  }
  return best;
}

template std::vector<std::array<int, 2>> border_facets<2>(const SimplexMesh<2>&);
template std::vector<std::array<int, 3>> border_facets<3>(const SimplexMesh<3>&);
template Point<2> nearest_on_facets<2>(const SimplexMesh<2>&,
                                       const std::vector<std::array<int, 2>>&, const Point<2>&);
template Point<3> nearest_on_facets<3>(const SimplexMesh<3>&,
                                       const std::vector<std::array<int, 3>>&, const Point<3>&);

}  // namespace crease
