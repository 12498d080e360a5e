#include "Transforms/Splines/NearestFacets.h"

#include <gtest/gtest.h>

#include <random>

#include "Core/Error.h"
#include "Testing/Transforms/Splines/TestNets.h"
#include "Transforms/Domains/Polygon.h"
#include "Transforms/Splines/KnotBorder.h"

namespace crease {
namespace {

TEST(NearestFacets, AreThoseOfTheCube) {
  const auto net = testing::tetrahedral_net(1, 0.4);
  const auto faces = border_facets<3>(net.mesh);
  ASSERT_EQ(faces.size(), 12u);
  const NearestFacets<3> border(net.mesh, faces);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> far(-10.0, 20.0), farther(-1e4, 1e4);
  for (int i = 0; i < 500; ++i) {
    auto& range = i % 5 == 0 ? farther : far;
    const Point<3> x(range(random), range(random), range(random));
    if (x.minCoeff() > 0 && x.maxCoeff() < 10) continue;
    const Point<3> truth = x.cwiseMax(0.0).cwiseMin(10.0);
    EXPECT_LT((border.find(x).point - truth).norm(), 1e-10 * (1 + x.norm()));
  }
}

TEST(NearestFacets, AreThoseOfALinearSearch) {
  const auto mesh = testing::jittered_mesh(9, 9, 3);
  const auto edges = border_facets<2>(mesh);
  const NearestFacets<2> border(mesh, edges);
  ASSERT_EQ(border.num_facets(), static_cast<int>(edges.size()));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-150, 250);
  for (int i = 0; i < 3000; ++i) {
    const Point<2> x(place(random), place(random));
    int nearest = -1;
    double least = 1e300;
    for (int e = 0; e < border.num_facets(); ++e) {
      const auto& [a, b] = border.corners(e);
      const double distance = (closest_point_on_segment(x, a, b) - x).squaredNorm();
      if (distance < least) {
        least = distance;
        nearest = e;
      }
    }
    const auto found = border.find(x);
    EXPECT_EQ(found.facet, nearest);
    EXPECT_EQ((found.point - x).squaredNorm(), least);
  }
}

TEST(NearestFacets, NeedFacets) { EXPECT_THROW(NearestFacets<2>().find({0, 0}), InvalidInput); }

}  // namespace
}  // namespace crease
