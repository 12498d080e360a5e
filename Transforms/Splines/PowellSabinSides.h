#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "Transforms/Domains/KnotNet.h"
#include "Transforms/Splines/PowellSabinSplit.h"

namespace crease {

/// On which side of the creases the triangles at each vertex lie.
class PowellSabinSides {
 public:
  /// @param normals  of the crease through each vertex, from its near to its far side; 0: none.
  /// @throws InvalidInput when a crease edge is no edge inside the domain, or the crease edges of a vertex with
  /// a normal do not divide its triangles in two; the message names the vertices.
  PowellSabinSides(const SimplexMesh<2>& mesh, const PowellSabinSplit& split,
                   std::span<const CreaseEdge> crease_edges, std::vector<Vector<2>> normals);

  /// Number among the crease edges of an edge of the mesh; -1: none of them.
  int crease_of(int edge) const { return crease_of_[edge]; }
  /// Whether a triangle lies on the far side of the crease through its corner.
  bool is_far(int triangle, int corner) const { return far_[triangle][corner]; }
  const Vector<2>& normal(int vertex) const { return normals_[vertex]; }

  /// The points at which the functions of a vertex V must not be negative, less V and lifted: the vertex,
  /// (V + R) / 2 for the points R of its edges, (V + Z) / 2 for the centres Z of its triangles. Rows are
  /// x, y, depth (PowellSabinVertex).
  Eigen::Matrix3Xd points(const SimplexMesh<2>& mesh, const PowellSabinSplit& split,
                          int vertex) const;

 private:
  void divide(const SimplexMesh<2>& mesh, const PowellSabinSplit& split, int vertex);

  std::vector<int> crease_of_;
  std::vector<Vector<2>> normals_;
  std::vector<std::array<bool, 3>> far_;
};

}  // namespace crease
