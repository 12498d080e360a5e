#pragma once

#include <Eigen/LU>
#include <array>
#include <vector>

#include "Core/Point.h"

namespace crease {

/// Triangles (2D) or tetrahedra (3D) that share vertices: conforming, positively oriented
/// (det[v_1 - v_0, ..., v_Dim - v_0] > 0).
template <int Dim>
struct SimplexMesh {
  std::vector<Point<Dim>> vertices;                 ///< mm
  std::vector<std::array<int, Dim + 1>> simplices;  ///< vertex numbers
  std::vector<int> regions;  ///< per simplex: 0 soft, k > 0 rigid body k; may be empty (all 0)

  int region(int simplex) const {
    return regions.empty() ? 0 : regions[static_cast<std::size_t>(simplex)];
  }
};

/// Twice the area (2D) or six times the volume (3D) of the simplex, positive when counter-clockwise.
template <int Dim>
double signed_content(const std::array<Point<Dim>, Dim + 1>& corners) {
  Matrix<Dim> edges;
  for (int a = 0; a < Dim; ++a) edges.col(a) = corners[a + 1] - corners[0];
  return edges.determinant();
}

}  // namespace crease
