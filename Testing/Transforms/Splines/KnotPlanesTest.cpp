#include "Transforms/Splines/KnotPlanes.h"

#include <gtest/gtest.h>

#include "Testing/Transforms/Splines/TestNets.h"
#include "Transforms/Splines/KnotLocator.h"

namespace crease {
namespace {

TEST(KnotPlanes, CollinearPairsShareALine) {
  const Point<2> a(3.1, -2.7), d(0.6, 0.8);
  std::vector<std::array<Point<2>, 2>> pairs;
  for (double s : {0.0, 1.3, 7.7, -120.0}) pairs.push_back({a + s * d, a + (s + 0.4) * d});
  pairs.push_back({a + 5.0 * d, a - 3.0 * d});           // the other way round
  pairs.push_back({a, a + d + Vector<2>(1e-6, -1e-6)});  // another line
  const auto merged = merge_planes<2>(pairs, 1e-9);
  EXPECT_EQ(merged.planes.size(), 2u);
  for (int i = 1; i < 5; ++i) EXPECT_EQ(merged.plane_of_facet[i], merged.plane_of_facet[0]);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& plane = merged.planes[merged.plane_of_facet[i]];
    EXPECT_NEAR(plane.normal.norm(), 1.0, 1e-15);
    for (const auto& p : pairs[i]) EXPECT_NEAR(plane.distance(p), 0.0, 1e-12);
  }
}

TEST(KnotPlanes, CoplanarTriplesShareAPlane) {
  const std::vector<std::array<Point<3>, 3>> facets = {
      {Point<3>(0, 0, 1), Point<3>(4, 0, 1), Point<3>(0, 4, 1)},
      {Point<3>(9, 9, 1), Point<3>(7, 9, 1), Point<3>(9, 5, 1)},
      {Point<3>(0, 0, 1), Point<3>(4, 0, 2), Point<3>(0, 4, 1)}};
  EXPECT_EQ(merge_planes<3>(facets, 1e-9).planes.size(), 2u);
}

TEST(KnotLocator, FindsTheHolderOrNone) {
  const auto mesh = testing::jittered_mesh(7, 4, 3);
  const KnotLocator<2> locator(mesh, 1e-9);
  const auto points = testing::points_inside(mesh, 3, 5);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(locator.find(points[i]), static_cast<int>(i / 3));
  }
  // On ties the lowest number wins.
  for (std::size_t t = 0; t < mesh.simplices.size(); ++t) {
    const auto v = simplex_corners(mesh, static_cast<int>(t));
    EXPECT_LE(locator.find(0.5 * (v[0] + v[1])), static_cast<int>(t));
    EXPECT_GE(locator.find(v[2]), 0);
  }
  EXPECT_EQ(locator.find({70.1, 20.0}), -1);
  EXPECT_EQ(locator.find({-1.0, -1.0}), -1);
}

}  // namespace
}  // namespace crease
