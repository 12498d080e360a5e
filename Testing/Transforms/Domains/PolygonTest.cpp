#include "Transforms/Domains/Polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "Testing/Transforms/Domains/SampleDomains.h"
#include "Transforms/Domains/ConvexPolygon.h"

namespace crease {
namespace {
const Polyline kEll = {{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 3}, {0, 3}};  // area 6
}  // namespace

TEST(Polygon, SignedAreaFollowsTheOrientation) {
  EXPECT_NEAR(signed_area(kEll), 6, 1e-14);
  EXPECT_NEAR(signed_area(Polyline(kEll.rbegin(), kEll.rend())), -6, 1e-14);
}

TEST(Polygon, PointInPolygonAgreesWithTheAnswerByHand) {
  EXPECT_TRUE(point_in_polygon(kEll, {0.5, 2.5}));
  EXPECT_TRUE(point_in_polygon(kEll, {3.5, 0.5}));
  EXPECT_FALSE(point_in_polygon(kEll, {2, 2}));
  EXPECT_FALSE(point_in_polygon(kEll, {-1, 0.5}));
  EXPECT_FALSE(point_in_polygon(kEll, {5, 1}));
}

TEST(Polygon, WindingCountsTurns) {
  Polyline twice = kEll;
  twice.insert(twice.end(), kEll.begin(), kEll.end());
  EXPECT_EQ(winding_number(twice, {0.5, 0.5}), 2);
}

TEST(Polygon, FindsTheCrossingOfABowTie) {
  const Polyline bow_tie = {{0, 0}, {2, 2}, {2, 0}, {0, 2}};
  const auto found = find_self_intersection(bow_tie, true);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->first_edge, 0);
  EXPECT_EQ(found->second_edge, 2);
  EXPECT_LT((found->point - Point<2>(1, 1)).norm(), 1e-14);
  EXPECT_FALSE(find_self_intersection(kEll, true));
}

TEST(Polygon, FindsTouchingFoldedAndOverlappingEdges) {
  EXPECT_TRUE(find_self_intersection(Polyline{{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}, true));
  EXPECT_TRUE(find_self_intersection(Polyline{{0, 0}, {2, 0}, {1, 0}, {1, 1}}, false));
  EXPECT_TRUE(
      find_self_intersection(Polyline{{0, 0}, {4, 0}, {4, 1}, {3, 1}, {3, 0}, {1, 0}}, false));
}

TEST(Polygon, SimplifyKeepsEndsAndTolerance) {
  Polyline wave;
  for (int i = 0; i <= 200; ++i) wave.emplace_back(0.05 * i, std::sin(0.05 * i));
  const Polyline simple = simplify_polyline(wave, false, 0.05);
  EXPECT_LT(simple.size(), 20U);
  EXPECT_EQ(simple.front(), wave.front());
  EXPECT_EQ(simple.back(), wave.back());
  for (const auto& p : wave) EXPECT_LE(distance_to_polyline(simple, false, p), 0.05);
}

TEST(Polygon, SimplifyOfAClosedSquareKeepsItsCorners) {
  Polyline square;
  for (const auto& [a, b] : {std::pair(Point<2>(0, 0), Point<2>(8, 0)),
                             {{8, 0}, {8, 8}},
                             {{8, 8}, {0, 8}},
                             {{0, 8}, {0, 0}}}) {
    for (int k = 0; k < 8; ++k) square.push_back(a + k / 8.0 * (b - a));
  }
  EXPECT_EQ(simplify_polyline(square, true, 0.1).size(), 4U);
}

TEST(Polygon, ResamplingIsEvenAlongTheLength) {
  const Polyline even = resample_polyline(kEll, true, 14);  // circumference 14
  ASSERT_EQ(even.size(), 14U);
  EXPECT_LT((even[4] - Point<2>(4, 0)).norm(), 1e-12);
  EXPECT_LT((even[9] - Point<2>(1, 2)).norm(), 1e-12);
  const Polyline open = resample_polyline(Polyline{{0, 0}, {3, 0}, {3, 1}}, false, 5);
  EXPECT_LT((open[3] - Point<2>(3, 0)).norm(), 1e-12);
  EXPECT_EQ(open.back(), Point<2>(3, 1));
}

TEST(Polygon, DistanceToPolyline) {
  EXPECT_NEAR(distance_to_polyline(kEll, true, {2, 2}), 1, 1e-14);
  EXPECT_NEAR(distance_to_polyline(kEll, true, {-3, -4}), 5, 1e-14);
  EXPECT_NEAR(distance_to_polyline(kEll, false, {-1, 1.5}), std::hypot(1, 1.5), 1e-14);
}

TEST(Polygon, IntersectingBoxesMatchBruteForce) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Point<2>> lower, upper;
  for (int i = 0; i < 60; ++i) {
    lower.emplace_back(uniform(generator), uniform(generator));
    upper.emplace_back(lower.back() + 0.2 * Vector<2>(uniform(generator), uniform(generator)));
  }
  std::vector<std::pair<int, int>> expected;
  for (int i = 0; i < 60; ++i) {
    for (int k = i + 1; k < 60; ++k) {
      if ((lower[i].array() <= upper[k].array()).all() &&
          (lower[k].array() <= upper[i].array()).all()) {
        expected.emplace_back(i, k);
      }
    }
  }
  EXPECT_EQ(intersecting_boxes(lower, upper), expected);
}

TEST(ConvexPolygon, DifferenceAndClipAddUp) {
  const Polyline triangle = {{0, 0}, {4, 0}, {1, 3}};
  const Polyline square = {{1, -1}, {3, -1}, {3, 1}, {1, 1}};
  const double common = signed_area(clipped_by_convex(triangle, square));
  double outside = 0;
  for (const auto& part : convex_difference(triangle, square)) outside += signed_area(part);
  EXPECT_NEAR(common, 2, 1e-13);  // the square's upper half lies in the triangle
  EXPECT_NEAR(common + outside, 6, 1e-13);
}

TEST(ConvexPolygon, HullDropsInnerAndCollinearPoints) {
  const Polyline hull =
      convex_hull(Polyline{{0, 0}, {2, 0}, {1, 0}, {2, 2}, {0, 2}, {1, 1}, {0, 0}});
  EXPECT_EQ(hull.size(), 4U);
  EXPECT_NEAR(signed_area(hull), 4, 1e-14);
  EXPECT_EQ(convex_hull(Polyline{{0, 0}, {1, 1}, {3, 3}}).size(), 2U);
}

}  // namespace crease
