#include "Geometry/SurfaceMesh.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "Geometry/SurfaceMeshFile.h"

namespace crease {
namespace {

SurfaceMesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

/// A torus of n x n squares.
SurfaceMesh torus(int n) {
  SurfaceMesh mesh;
  mesh.vertices.resize(static_cast<std::size_t>(n) * n, Point<3>::Zero());
  const auto number = [n](int i, int j) { return i % n * n + j % n; };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      mesh.faces.push_back(
          {number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)});
    }
  }
  return mesh;
}

}  // namespace

TEST(SurfaceTopology, SpheresAndTori) {
  const auto ball = surface_topology(tetrahedron());
  EXPECT_EQ(ball.edges, 6);
  EXPECT_EQ(ball.euler, 2);
  EXPECT_EQ(ball.genus, 0);
  EXPECT_EQ(ball.boundary_loops, 0);
  EXPECT_EQ(surface_topology(torus(5)).genus, 1);
  EXPECT_EQ(surface_topology(torus(5)).euler, 0);
}

TEST(SurfaceTopology, HolesAndParts) {
  SurfaceMesh mesh = torus(6);
  mesh.faces.erase(mesh.faces.begin() + 20);
  mesh.faces.erase(mesh.faces.begin());
  EXPECT_EQ(surface_topology(mesh).boundary_loops, 2);
  EXPECT_EQ(surface_topology(mesh).genus, 1);
  for (auto face : tetrahedron().faces) {
    for (int& v : face) v += 36;
    mesh.faces.push_back(face);
  }
  mesh.vertices.resize(41, Point<3>::Zero());  // the last one belongs to no face
  EXPECT_EQ(surface_topology(mesh).components, 2);
  EXPECT_EQ(surface_topology(mesh).genus, 1);
}

TEST(SurfaceTopology, EdgesWithThreeFacesHaveNoGenus) {
  SurfaceMesh mesh = tetrahedron();
  mesh.vertices.emplace_back(1, 1, 1);
  mesh.faces.push_back({0, 1, 4});
  EXPECT_EQ(surface_topology(mesh).non_manifold_edges, 1);
  EXPECT_EQ(surface_topology(mesh).genus, -1);
}

// Figures of the files' authors.
TEST(SurfaceTopology, RealMeshes) {
  struct Known {
    const char* file;
    int vertices, faces, loops, genus;
  };
  for (const Known& known : {Known{"bunny.off", 3485, 6966, 0, 0},
                             {"torus.off", 1200, 2400, 0, 1},
                             {"fandisk.obj", 6475, 12946, 0, 0},
                             {"face.off", 1180, 2000, 1, 0}}) {
    const auto file = std::filesystem::path(CREASE_SHARED_DIR) / "data/meshes" / known.file;
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "the meshes are not there";
    const SurfaceMesh mesh = read_surface_mesh(file);
    EXPECT_EQ(static_cast<int>(mesh.vertices.size()), known.vertices) << known.file;
    EXPECT_EQ(static_cast<int>(mesh.faces.size()), known.faces) << known.file;
    EXPECT_EQ(surface_topology(mesh).boundary_loops, known.loops) << known.file;
    EXPECT_EQ(surface_topology(mesh).genus, known.genus) << known.file;
  }
}

}  // namespace crease
