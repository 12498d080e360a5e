#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "Transforms/Domains/MeshTopology.h"

namespace crease {

/// Every triangle of a mesh cut into six: its centre Z joined to its corners V and to a point R on each
/// of its edges.
///
/// Z is the incentre, Z = sum_i a_i V_i with a_i the length of the edge opposite. The angles between an edge and
/// the lines to the incentres on both its sides are below 90 degrees, so that the line between these
/// incentres always crosses the edge between its ends: there lies R, the same for both triangles, and this
/// is what makes quadratics on the small triangles C1 across the edge. (Circumcentres do so on Delaunay
/// meshes of acute triangles alone, centroids not always.) On the border R is the edge's midpoint.
///
/// Source: M. J. D. Powell and M. A. Sabin, "Piecewise Quadratic Approximations on Triangles", ACM
/// Transactions on Mathematical Software 3, 1977.
class PowellSabinSplit {
 public:
  /// @throws InvalidInput for what MeshTopology refuses, numbers that are not finite, as many regions as
  /// there are triangles or none, triangles that are flat, folded or lie on the same side of their
  /// common edge, vertices without a triangle; the message names them.
  explicit PowellSabinSplit(const SimplexMesh<2>& mesh);

  const MeshTopology& topology() const { return topology_; }
  /// Z of a triangle, mm, and its barycentric coordinates: positive, sum = 1.
  const Point<2>& centre(int triangle) const { return centres_[triangle]; }
  const Vector<3>& centre_weights(int triangle) const { return centre_weights_[triangle]; }
  /// Number of the edge from corner `side` of a triangle to the next.
  int edge_of(int triangle, int side) const { return edges_of_[triangle][side]; }
  /// R of an edge, mm.
  const Point<2>& edge_point(int edge) const { return edge_points_[edge]; }
  /// Weight of a vertex of the edge in R = share(a) V_a + share(b) V_b: in (0, 1), sum = 1.
  double share(int edge, int vertex) const {
    return topology_.edges()[edge].vertices[0] == vertex ? shares_[edge] : 1 - shares_[edge];
  }

 private:
  void set_centres(const SimplexMesh<2>& mesh);
  void set_edge_points(const SimplexMesh<2>& mesh);

  MeshTopology topology_;
  std::vector<Point<2>> centres_, edge_points_;
  std::vector<Vector<3>> centre_weights_;
  std::vector<std::array<int, 3>> edges_of_;
  std::vector<double> shares_;  // of the lower vertex
};

}  // namespace crease
