#include "Transforms/Splines/KnotPlanes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace crease {
namespace {

// A direction that no knot line is expected to be parallel or orthogonal to.
template <int Dim>
Vector<Dim> generic_direction() {
  const Vector<3> v(0.52573111211913360603, 0.68819096023558676910, 0.50047184123517293);
  return v.template head<Dim>();
}

template <int Dim>
Vector<Dim> facet_normal(const std::array<Point<Dim>, Dim>& facet) {
  if constexpr (Dim == 2) {
    const Vector<2> d = facet[1] - facet[0];
    return {-d[1], d[0]};
  } else {
    return (facet[1] - facet[0]).cross(facet[2] - facet[0]);
  }
}

template <int Dim>
struct Candidate {
  KnotPlane<Dim> plane;
  double size = 0.0;  // length or twice the area: large facets define a plane best
  double key = 0.0;   // equal planes have equal keys
};

template <int Dim>
std::vector<Candidate<Dim>> candidates(std::span<const std::array<Point<Dim>, Dim>> facets,
                                       double scale) {
  std::vector<Candidate<Dim>> result(facets.size());
  for (std::size_t f = 0; f < facets.size(); ++f) {
    Vector<Dim> normal = facet_normal<Dim>(facets[f]);
    result[f].size = normal.norm();
    normal /= result[f].size;
    if (normal.dot(generic_direction<Dim>()) < 0.0) normal = -normal;
    result[f].plane = {normal, normal.dot(facets[f][0])};
    Vector<Dim> weights = Vector<Dim>::LinSpaced(0.7548776662466927, 0.5698402909980532);
    result[f].key = weights.dot(normal) + result[f].plane.offset / scale;
  }
  return result;
}

template <int Dim>
bool on_plane(const std::array<Point<Dim>, Dim>& facet, const KnotPlane<Dim>& plane, double tie) {
  return std::all_of(facet.begin(), facet.end(),
                     [&](const Point<Dim>& p) { return std::abs(plane.distance(p)) <= tie; });
}

}  // namespace

template <int Dim>
KnotPlanes<Dim> merge_planes(std::span<const std::array<Point<Dim>, Dim>> facets, double tie) {
  double scale = 1.0;
  for (const auto& facet : facets) scale = std::max(scale, facet[0].cwiseAbs().maxCoeff());
  const auto found = candidates<Dim>(facets, scale);
  std::vector<int> by_key(facets.size());
  std::iota(by_key.begin(), by_key.end(), 0);
  std::sort(by_key.begin(), by_key.end(), [&](int a, int b) {
    return found[a].key != found[b].key ? found[a].key < found[b].key : a < b;
  });

  // Every facet follows the largest one near its key that it lies on.
  constexpr double kKeyWindow = 1e-7;
  const auto larger = [&](int a, int b) {
    return found[a].size != found[b].size ? found[a].size > found[b].size : a < b;
  };
  std::vector<int> leader(facets.size());
  std::iota(leader.begin(), leader.end(), 0);
  for (std::size_t i = 0; i < by_key.size(); ++i) {
    for (std::size_t k = i + 1; k < by_key.size(); ++k) {
      int large = by_key[i], small = by_key[k];
      if (found[small].key - found[large].key > kKeyWindow) break;
      if (larger(small, large)) std::swap(large, small);
      if (larger(large, leader[small]) && on_plane<Dim>(facets[small], found[large].plane, tie)) {
        leader[small] = large;
      }
    }
  }

  KnotPlanes<Dim> result;
  result.plane_of_facet.resize(facets.size());
  std::vector<int> number(facets.size(), -1);
  for (std::size_t f = 0; f < facets.size(); ++f) {
    int root = leader[f];
    while (leader[root] != root) root = leader[root];
    if (number[root] < 0) {
      number[root] = static_cast<int>(result.planes.size());
      result.planes.push_back(found[root].plane);
    }
    result.plane_of_facet[f] = number[root];
  }
  return result;
}

template KnotPlanes<2> merge_planes<2>(std::span<const std::array<Point<2>, 2>>, double);
template KnotPlanes<3> merge_planes<3>(std::span<const std::array<Point<3>, 3>>, double);

}  // namespace crease
