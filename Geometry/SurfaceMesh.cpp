#include "Geometry/SurfaceMesh.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

namespace crease {
namespace {

/// Sets of numbers that are merged pair by pair.
class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int root(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(int i, int k) { parent_[root(i)] = root(k); }

 private:
  std::vector<int> parent_;
};

}  // namespace

SurfaceTopology surface_topology(const SurfaceMesh& mesh) {
  std::map<std::pair<int, int>, int> faces_of_edge;
  Groups parts(mesh.vertices.size()), rings(mesh.vertices.size());
  std::set<int> used;
  for (const auto& face : mesh.faces) {
    for (std::size_t k = 0; k < face.size(); ++k) {
      const int a = face[k], b = face[(k + 1) % face.size()];
      ++faces_of_edge[std::minmax(a, b)];
      parts.join(a, b);
      used.insert(a);
    }
  }
  SurfaceTopology topology;
  topology.edges = static_cast<int>(faces_of_edge.size());
  std::set<int> part_roots, ring_roots, border;
  for (const auto& [edge, count] : faces_of_edge) {
    if (count > 2) ++topology.non_manifold_edges;
    if (count != 1) continue;
    rings.join(edge.first, edge.second);
    border.insert(edge.first);
  }
  for (int v : used) part_roots.insert(parts.root(v));
  for (int v : border) ring_roots.insert(rings.root(v));
  topology.components = static_cast<int>(part_roots.size());
  topology.boundary_loops = static_cast<int>(ring_roots.size());
  topology.euler =
      static_cast<int>(used.size()) - topology.edges + static_cast<int>(mesh.faces.size());
  const int handles = 2 * topology.components - topology.boundary_loops - topology.euler;
  if (topology.non_manifold_edges == 0 && handles >= 0 && handles % 2 == 0) {
    topology.genus = handles / 2;
  }
  return topology;
}

}  // namespace crease
