#pragma once

#include <algorithm>
#include <set>
#include <utility>

#include "Transforms/Domains/SimplexMesh.h"

namespace crease {

/// Mean length of the edges, each counted once.
template <int Dim>
double mean_edge_length(const SimplexMesh<Dim>& mesh) {
  std::set<std::pair<int, int>> edges;
  for (const auto& simplex : mesh.simplices) {
    for (int j = 0; j <= Dim; ++j) {
      for (int k = 0; k < j; ++k) edges.insert(std::minmax(simplex[j], simplex[k]));
    }
  }
  double sum = 0.0;
  for (const auto& [a, b] : edges) sum += (mesh.vertices[a] - mesh.vertices[b]).norm();
  return sum / static_cast<double>(edges.size());
}

/// Of one simplex.
template <int Dim>
double mean_edge_length(const SimplexMesh<Dim>& mesh, int simplex) {
  const auto& corners = mesh.simplices[static_cast<std::size_t>(simplex)];
  double sum = 0.0;
  for (int j = 0; j <= Dim; ++j) {
    for (int k = 0; k < j; ++k) {
      sum += (mesh.vertices[corners[j]] - mesh.vertices[corners[k]]).norm();
    }
  }
  constexpr int kNumEdges = Dim * (Dim + 1) / 2;
  return sum / kNumEdges;
}

}  // namespace crease
