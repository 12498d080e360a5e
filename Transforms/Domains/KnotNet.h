#pragma once

#include <array>
#include <vector>

#include "Transforms/Domains/SimplexMesh.h"

namespace crease {

/// An edge of the mesh along which the gradient may jump.
struct CreaseEdge {
  std::array<int, 2> vertices{};
  bool body_side =
      false;  ///< a body lies on one side, and the band of the crease wholly outside it
};

/// A mesh whose vertices carry clouds of knots: all that a triangular B-spline basis is built from.
/// Source: Dahmen, Micchelli, Seidel, "Blossoming Begets B-Spline Bases Built Better by B-Patches",
/// Math. Comp. 59, 1992.
template <int Dim>
struct KnotNet {
  int degree = 3;
  SimplexMesh<Dim> mesh;
  /// Per vertex `degree` knots t_0 = the vertex, t_1 .. t_{degree-1} (for degree 0 and 1 the vertex
  /// alone). The last knot t_degree is t_0: with shared control points it cancels.
  std::vector<std::vector<Point<Dim>>> clouds;
  std::vector<CreaseEdge> crease_edges;  ///< whose bands carry no bending energy
};

}  // namespace crease
