#include "Transforms/Splines/KnotControlPoints.h"

#include <gtest/gtest.h>

#include <cmath>

#include "Testing/Transforms/Splines/TestNets.h"

namespace crease {
namespace {

TEST(KnotControlPoints, AreAsManyAsLagrangeNodes) {
  EXPECT_EQ(KnotControlPoints<2>(testing::grid_mesh(6, 6), 3).count(), 361);
  // V = 83, T = 130: 64 squares and a triangle outside each of two border edges.
  SimplexMesh<2> mesh = testing::grid_mesh(8, 8);
  mesh.vertices.emplace_back(5.0, -8.0);
  mesh.simplices.push_back({1, 0, 81});
  mesh.vertices.emplace_back(25.0, -8.0);
  mesh.simplices.push_back({3, 2, 82});
  ASSERT_EQ(mesh.vertices.size(), 83u);
  ASSERT_EQ(mesh.simplices.size(), 130u);
  EXPECT_EQ(KnotControlPoints<2>(mesh, 3).count(), 637);
  EXPECT_EQ(KnotControlPoints<2>(mesh, 2).count(), 2 * 83 + 130 - 1);
  const SimplexMesh<3> solid = testing::tetrahedral_net(2, 0.4).mesh;
  EXPECT_EQ(KnotControlPoints<3>(solid, 1).count(), 9);
  EXPECT_EQ(KnotControlPoints<3>(solid, 2).count(), 9 + 26);
  EXPECT_EQ(KnotControlPoints<3>(solid, 3).count(), 9 + 2 * 26 + 30);
}

// The polar form's arguments of a shared control point are the same knots from every side.
template <int Dim>
void expect_agreement(const KnotNet<Dim>& net, const std::array<int, Dim>& exponents) {
  const KnotControlPoints<Dim> control_points(net.mesh, net.degree);
  const auto betas = multi_indices<Dim>(net.degree);
  std::vector<double> value(control_points.count(), std::nan(""));
  for (std::size_t s = 0; s < net.mesh.simplices.size(); ++s) {
    for (std::size_t k = 0; k < betas.size(); ++k) {
      std::vector<Point<Dim>> arguments;
      for (int j = 0; j <= Dim; ++j) {
        const auto& cloud = net.clouds[net.mesh.simplices[s][j]];
        arguments.insert(arguments.end(), cloud.begin(), cloud.begin() + betas[k][j]);
      }
      const double here = monomial_polar_form<Dim>(exponents, arguments);
      double& known = value[control_points.of_simplex(static_cast<int>(s))[k]];
      if (std::isnan(known)) known = here;
      EXPECT_NEAR(here, known, 1e-12 * std::abs(known));
    }
  }
}

TEST(KnotControlPoints, AgreeOnAllSides) {
  expect_agreement<2>(testing::jittered_net(3, 3, 3, 0.4, 1), {2, 1});
  expect_agreement<2>(testing::ring_net(4, 0.4, true), {1, 3});
  expect_agreement<3>(testing::tetrahedral_net(3, 0.4), {1, 1, 1});
}

TEST(KnotControlPoints, PolarFormsAreSymmetricAffineAndDiagonal) {
  const std::vector<Point<2>> p = {{1.0, 2.0}, {-3.0, 0.5}, {2.0, -1.5}, {0.3, 0.7}};
  const std::array<int, 2> xxy = {2, 1};
  const auto value = [&](std::vector<Point<2>> arguments) {
    return monomial_polar_form<2>(xxy, arguments);
  };
  EXPECT_NEAR(value({p[0], p[1], p[2]}), value({p[2], p[0], p[1]}), 1e-14);
  EXPECT_NEAR(value({p[3], p[3], p[3]}), 0.3 * 0.3 * 0.7, 1e-15);
  EXPECT_NEAR(value({0.25 * p[0] + 0.75 * p[3], p[1], p[2]}),
              0.25 * value({p[0], p[1], p[2]}) + 0.75 * value({p[3], p[1], p[2]}), 1e-14);
  // By hand: (x1 x2 y3 + x1 x3 y2 + x2 x3 y1) / 3.
  EXPECT_NEAR(value({p[0], p[1], p[2]}), (-3.0 * -1.5 + 2.0 * 0.5 + -6.0 * 2.0) / 3.0, 1e-14);
}

}  // namespace
}  // namespace crease
