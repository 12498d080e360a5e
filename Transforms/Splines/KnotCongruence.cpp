#include "Transforms/Splines/KnotCongruence.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "Transforms/Splines/KnotLocator.h"

namespace crease {
namespace {

constexpr double kSame = 2e-15;     // of the domain: no more than coordinates are rounded by
constexpr double kHashGrid = 1e-9;  // of the domain

// Knots of some triangles relative to a point, one coordinate after the other.
void append_knots(const KnotNet<2>& net, int triangle, const Point<2>& origin,
                  std::vector<double>& coordinates) {
  for (int v : net.mesh.simplices[triangle]) {
    for (const auto& knot : net.clouds[v]) {
      coordinates.push_back(knot.x() - origin.x());
      coordinates.push_back(knot.y() - origin.y());
    }
  }
}

std::uint64_t hash(const std::vector<double>& coordinates, double grid) {
  std::uint64_t h = 0;
  for (double c : coordinates) {
    h = (h ^ static_cast<std::uint64_t>(std::llround(c / grid))) * 0x9e3779b97f4a7c15u;
    h ^= h >> 29;
  }
  return h;
}

bool same(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [&](double x, double y) {
           return std::abs(x - y) <= tolerance;
         });
}

}  // namespace

KnotCongruence::KnotCongruence(const KnotNet<2>& net) : neighbours_(vertex_neighbours(net.mesh)) {
  const int count = static_cast<int>(net.mesh.simplices.size());
  const double scale = mesh_scale(net.mesh);
  const Vector<2> generic(0.5698402909980532, 0.8217530126134217);
  std::unordered_map<std::uint64_t, std::vector<int>> alike;  // by their own three clouds
  std::vector<double> coordinates;
  for (int t = 0; t < count; ++t) {
    coordinates.clear();
    append_knots(net, t, net.mesh.vertices[net.mesh.simplices[t][0]], coordinates);
    alike[hash(coordinates, kHashGrid * scale)].push_back(t);
    std::sort(neighbours_[t].begin(), neighbours_[t].end(), [&](int a, int b) {
      const double ha = generic.dot(simplex_centroid(net.mesh, a));
      const double hb = generic.dot(simplex_centroid(net.mesh, b));
      return ha != hb ? ha < hb : a < b;
    });
  }

  representative_.resize(count);
  for (int t = 0; t < count; ++t) representative_[t] = t;
  for (const auto& [key, triangles] : alike) {
    if (triangles.size() < 2) continue;
    std::vector<std::pair<int, std::vector<double>>> kinds;
    for (int t : triangles) {
      coordinates.clear();
      const Point<2>& origin = net.mesh.vertices[net.mesh.simplices[t][0]];
      for (int n : neighbours_[t]) append_knots(net, n, origin, coordinates);
      const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) {
        return same(k.second, coordinates, kSame * scale);
      });
      if (kind == kinds.end()) {
        kinds.emplace_back(t, coordinates);
      } else {
        representative_[t] = kind->first;
      }
    }
  }
}

}  // namespace crease
