#include "Transforms/Domains/StructuredTriangulation.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "Core/Error.h"
#include "Testing/Transforms/Domains/SampleDomains.h"
#include "Transforms/Domains/MeshTopology.h"

namespace crease {

TEST(StructuredTriangulation, CountsOfTheDissertation) {
  const auto mesh = structured_triangulation(testing::box(0, 0, 6, 6), 6, 6);
  const auto figures = mesh_figures(mesh);
  EXPECT_EQ(figures.num_triangles, 72);
  // Cubic control points: V + 2 E + T.
  EXPECT_EQ(figures.num_vertices + 2 * figures.num_edges + figures.num_triangles, 361);
  EXPECT_NEAR(figures.area, 36, 1e-12);
  EXPECT_NEAR(figures.smallest_angle_deg, 45, 1e-9);
}

TEST(StructuredTriangulation, UnionJackDiagonalsPassEvenVertices) {
  const auto mesh = structured_triangulation(testing::box(0, 0, 4, 4), 4, 4);
  const MeshTopology topology(mesh);
  for (const auto& edge : topology.edges()) {
    const Point<2>&a = mesh.vertices[edge.vertices[0]], &b = mesh.vertices[edge.vertices[1]];
    if ((b - a).norm() < 1.1) continue;
    for (const auto& p : {a, b}) EXPECT_EQ(std::lround(p.x() + p.y()) % 2, 0);
  }
}

TEST(StructuredTriangulation, OneDiagonalDirection) {
  for (const auto diagonals : {Diagonals::kRising, Diagonals::kFalling}) {
    const auto mesh = structured_triangulation(testing::box(0, 0, 3, 1), 3, 2, diagonals);
    const MeshTopology topology(mesh);
    for (const auto& edge : topology.edges()) {
      const Vector<2> d = mesh.vertices[edge.vertices[1]] - mesh.vertices[edge.vertices[0]];
      if (d.x() == 0 || d.y() == 0) continue;
      EXPECT_EQ(d.x() * d.y() > 0, diagonals == Diagonals::kRising);
    }
    EXPECT_NEAR(mesh_figures(mesh).area, 3, 1e-13);
  }
}

TEST(StructuredTriangulation, SixTetrahedraPerCubeConformAndFill) {
  Box<3> box;
  box.add({0, 0, 0});
  box.add({2, 3, 1});
  const auto mesh = structured_tetrahedra(box, {2, 3, 1});
  EXPECT_EQ(mesh.simplices.size(), 36U);
  double volume = 0;
  for (const auto& s : mesh.simplices) {
    const double v = signed_content<3>({mesh.vertices[s[0]], mesh.vertices[s[1]],
                                        mesh.vertices[s[2]], mesh.vertices[s[3]]}) /
                     6;
    EXPECT_GT(v, 0.1);
    volume += v;
  }
  EXPECT_NEAR(volume, 6, 1e-12);
}

TEST(StructuredTriangulation, BadInputIsRefused) {
  EXPECT_THROW(structured_triangulation(testing::box(0, 0, 1, 1), 0, 3), InvalidInput);
  EXPECT_THROW(structured_triangulation(testing::box(0, 0, 0, 1), 2, 3), InvalidInput);
  EXPECT_THROW(structured_tetrahedra(Box<3>(), {1, 1, 1}), InvalidInput);
}

TEST(AttachFeatureLines, DiamondOfExperimentOneLabelsItsTriangles) {
  const auto mesh = structured_triangulation(testing::box(0, 0, 6, 6), 6, 6);
  const auto domain =
      attach_feature_lines(mesh, {testing::closed_line({{5, 3}, {3, 5}, {1, 3}, {3, 1}})});
  ASSERT_EQ(domain.chains.size(), 1U);
  EXPECT_TRUE(domain.chains[0].closed);
  EXPECT_EQ(domain.chains[0].vertices.size(), 8U);
  EXPECT_EQ(domain.chains[0].body, BodySide::kLeft);
  EXPECT_NEAR(testing::region_area(domain.mesh, 1), 8, 1e-12);
  EXPECT_NEAR(testing::region_area(domain.mesh, 0), 28, 1e-12);
}

TEST(AttachFeatureLines, LinesOffTheEdgesAreNamed) {
  const auto mesh = structured_triangulation(testing::box(0, 0, 6, 6), 6, 6);
  EXPECT_THROW(attach_feature_lines(mesh, {testing::open_line({{0, 0}, {1, 0.5}})}), InvalidInput);
  EXPECT_THROW(attach_feature_lines(mesh, {testing::open_line({{0, 0}, {2, 1}})}), InvalidInput);
  FeatureLine slide = testing::open_line({{0, 1}, {6, 1}});
  slide.kind = FeatureKind::kSlide;
  EXPECT_THROW(attach_feature_lines(mesh, {slide}), InvalidInput);
}

}  // namespace crease
