#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "Testing/Transforms/Domains/SampleDomains.h"
#include "Testing/Transforms/Splines/TestNets.h"
#include "Transforms/Domains/Mesher.h"

namespace crease::testing {

struct NamedMesh {
  std::string name;
  SimplexMesh<2> mesh;
};
inline void PrintTo(const NamedMesh& mesh, std::ostream* stream) { *stream << mesh.name; }

/// Shrunk or grown so that coordinates are 8 at most: absolute tolerances refer to such meshes.
inline SimplexMesh<2> within_eight(SimplexMesh<2> mesh) {
  double largest = 0;
  for (const auto& v : mesh.vertices) largest = std::max(largest, v.cwiseAbs().maxCoeff());
  for (auto& v : mesh.vertices) v *= 8 / largest;
  return mesh;
}

/// An L of 8 x 8 with a square hole: inward corners and two borders.
inline SimplexMesh<2> concave_mesh(double edge_length = 1.5) {
  const RegionOfInterest region(
      {{{0, 0}, {8, 0}, {8, 3}, {3, 3}, {3, 8}, {0, 8}}, {{1, 1}, {1, 2}, {2, 2}, {2, 1}}});
  return mesh_domain(region, {}, {.edge_length = edge_length}).mesh;
}

/// Meshes with vertices of every kind: six, four and eight neighbours, corners with one triangle and with
/// two, inward corners, needles.
inline std::vector<NamedMesh> powell_sabin_meshes() {
  auto needles = grid_mesh(3, 3);
  for (auto& v : needles.vertices) v.y() /= 30;
  return {{"jittered", within_eight(jittered_mesh(4, 3, 1))},
          {"union jack", structured_triangulation(box(0, 0, 8, 8), 4, 4, Diagonals::kUnionJack)},
          {"rising", structured_triangulation(box(-8, -8, 8, 8), 3, 4, Diagonals::kRising)},
          {"one triangle", {{{0, 0}, {7, 1}, {2, 5}}, {{0, 1, 2}}, {}}},
          {"needles", within_eight(needles)},
          {"concave", concave_mesh()}};
}

}  // namespace crease::testing
