#include "Transforms/Splines/PowellSabinSides.h"

#include <algorithm>

#include "Core/Error.h"

namespace crease {
namespace {

int corner_of(const SimplexMesh<2>& mesh, int triangle, int vertex) {
  const auto& s = mesh.simplices[triangle];
  return static_cast<int>(std::find(s.begin(), s.end(), vertex) - s.begin());
}

}  // namespace

PowellSabinSides::PowellSabinSides(const SimplexMesh<2>& mesh, const PowellSabinSplit& split,
                                   std::span<const CreaseEdge> crease_edges,
                                   std::vector<Vector<2>> normals)
    : crease_of_(split.topology().edges().size(), -1),
      normals_(std::move(normals)),
      far_(mesh.simplices.size(), {false, false, false}) {
  const int num_vertices = static_cast<int>(mesh.vertices.size());
  for (std::size_t c = 0; c < crease_edges.size(); ++c) {
    const auto [a, b] = crease_edges[c].vertices;
    const bool known = std::min(a, b) >= 0 && std::max(a, b) < num_vertices;
    const int edge = known ? split.topology().edge_between(a, b) : -1;
    if (edge < 0 || split.topology().edges()[edge].triangles[1] < 0) {
      throw InvalidInput(
          message("Powell-Sabin net: crease edge ", a, ", ", b, " is no edge inside the mesh."));
    }
    crease_of_[edge] = static_cast<int>(c);
  }
  for (int v = 0; v < num_vertices; ++v) {
    if (!normals_[v].isZero(0)) divide(mesh, split, v);
  }
}

// The triangles at a vertex fall into two parts, joined across edges that are no creases; the far one has
// its centres in the direction of the normal in the mean.
void PowellSabinSides::divide(const SimplexMesh<2>& mesh, const PowellSabinSplit& split,
                              int vertex) {
  const auto& topology = split.topology();
  const auto& triangles = topology.triangles_at(vertex);
  std::vector<int> part(triangles.size());  // of a triangle: the first one that it is joined to
  for (std::size_t i = 0; i < part.size(); ++i) part[i] = static_cast<int>(i);
  const auto place = [&](int triangle) {
    return std::find(triangles.begin(), triangles.end(), triangle) - triangles.begin();
  };
  for (std::size_t round = 0; round < triangles.size(); ++round) {
    for (int e : topology.edges_at(vertex)) {
      const auto [p, q] = topology.edges()[e].triangles;
      if (q < 0 || crease_of_[e] >= 0) continue;
      part[place(p)] = part[place(q)] = std::min(part[place(p)], part[place(q)]);
    }
  }
  const int second = *std::max_element(part.begin(), part.end());
  double height[2] = {0, 0};
  int count[2] = {0, 0};
  for (std::size_t i = 0; i < part.size(); ++i) {
    const int side = part[i] == part[0] ? 0 : part[i] == second ? 1 : -1;
    if (side < 0) count[0] = 0;
    if (side < 0) break;
    const Vector<2> d = split.centre(triangles[i]) - mesh.vertices[vertex];
    height[side] += normals_[vertex].dot(d.normalized());
    ++count[side];
  }
  if (count[0] == 0 || count[1] == 0) {
    throw InvalidInput(message("Powell-Sabin net: the crease edges at vertex ", vertex,
                               " do not divide its triangles in two, but it has a normal."));
  }
  const bool first_is_far = height[0] / count[0] > height[1] / count[1];
  for (std::size_t i = 0; i < part.size(); ++i) {
    far_[triangles[i]][corner_of(mesh, triangles[i], vertex)] =
        (part[i] == part[0]) == first_is_far;
  }
}

Eigen::Matrix3Xd PowellSabinSides::points(const SimplexMesh<2>& mesh, const PowellSabinSplit& split,
                                          int vertex) const {
  const auto& topology = split.topology();
  const auto& edges = topology.edges_at(vertex);
  const auto& triangles = topology.triangles_at(vertex);
  Eigen::Matrix3Xd points(3, 1 + edges.size() + triangles.size());
  Eigen::Index count = 0;
  const auto add = [&](const Vector<2>& d, bool far) {
    points.col(count++) << d, far ? normals_[vertex].dot(d) : 0.0;
  };
  const auto far = [&](int t) { return is_far(t, corner_of(mesh, t, vertex)); };
  const Point<2>& v = mesh.vertices[vertex];
  add(Vector<2>::Zero(), false);
  for (int e : edges) {
    add(0.5 * (split.edge_point(e) - v),
        crease_of_[e] < 0 && far(topology.edges()[e].triangles[0]));
  }
  for (int t : triangles) add(0.5 * (split.centre(t) - v), far(t));
  return points;
}

}  // namespace crease
