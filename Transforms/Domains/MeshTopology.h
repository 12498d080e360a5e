#pragma once

#include <array>
#include <vector>

#include "Transforms/Domains/SimplexMesh.h"

namespace crease {

/// Who touches whom in a triangulation: triangles at a vertex, edges, the border.
class MeshTopology {
 public:
  /// An edge of the mesh and the triangles beside it.
  struct Edge {
    std::array<int, 2> vertices{};           ///< ascending
    std::array<int, 2> triangles{{-1, -1}};  ///< the second is -1 on the border
  };

  /// @throws InvalidInput when vertex numbers are out of range or an edge has more than two triangles.
  explicit MeshTopology(const SimplexMesh<2>& mesh);

  const std::vector<Edge>& edges() const { return edges_; }
  /// Number of the edge between two vertices; -1: none.
  int edge_between(int a, int b) const;
  const std::vector<int>& edges_at(int vertex) const { return edges_at_[vertex]; }
  const std::vector<int>& triangles_at(int vertex) const { return triangles_at_[vertex]; }
  int other_end(int edge, int vertex) const {
    const auto& v = edges_[edge].vertices;
    return v[0] == vertex ? v[1] : v[0];
  }
  bool on_border(int vertex) const { return !border_edges_at_[vertex].empty(); }
  /// Border edges at a vertex: none, two, or more where parts of the domain touch in a point.
  const std::vector<int>& border_edges_at(int vertex) const { return border_edges_at_[vertex]; }

 private:
  std::vector<Edge> edges_;
  std::vector<std::vector<int>> edges_at_, triangles_at_, border_edges_at_;
};

}  // namespace crease
