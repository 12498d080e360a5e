#include "Transforms/Domains/MeshTopology.h"

#include <algorithm>

#include "Core/Error.h"

namespace crease {

MeshTopology::MeshTopology(const SimplexMesh<2>& mesh) {
  const int num_vertices = static_cast<int>(mesh.vertices.size());
  edges_at_.resize(num_vertices);
  triangles_at_.resize(num_vertices);
  border_edges_at_.resize(num_vertices);
  for (std::size_t t = 0; t < mesh.simplices.size(); ++t) {
    const int triangle = static_cast<int>(t);
    for (int v : mesh.simplices[t]) {
      if (v < 0 || v >= num_vertices) {
        throw InvalidInput(message("mesh: triangle ", t, " names vertex ", v, ", but there are ",
                                   num_vertices, " vertices."));
      }
      triangles_at_[v].push_back(triangle);
    }
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.simplices[t][k], b = mesh.simplices[t][(k + 1) % 3];
      const int known = edge_between(a, b);
      if (known < 0) {
        const int number = static_cast<int>(edges_.size());
        edges_.push_back({{std::min(a, b), std::max(a, b)}, {triangle, -1}});
        edges_at_[a].push_back(number);
        edges_at_[b].push_back(number);
      } else if (edges_[known].triangles[1] < 0 && edges_[known].triangles[0] != triangle) {
        edges_[known].triangles[1] = triangle;
      } else {
        throw InvalidInput(message("mesh: more than two triangles share the edge between vertices ",
                                   a, " and ", b, "."));
      }
    }
  }
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    if (edges_[e].triangles[1] >= 0) continue;
    for (int v : edges_[e].vertices) border_edges_at_[v].push_back(static_cast<int>(e));
  }
}

int MeshTopology::edge_between(int a, int b) const {
  for (int e : edges_at_[a]) {
    if (other_end(e, a) == b) return e;
  }
  return -1;
}

}  // namespace crease
