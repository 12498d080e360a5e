#include "Transforms/Domains/CurveSampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "Testing/Transforms/Domains/SampleDomains.h"

namespace crease {
namespace {

SampledCurve sample(const Polyline& points, bool closed, double length, double tolerance,
                    bool keep_area = false) {
  return sample_curve(points, closed, [=](const Point<2>&) { return length; },
                      {.tolerance = tolerance, .keep_area = keep_area});
}

}  // namespace

TEST(CurveSampling, DividesLongEdgesAndKeepsCorners) {
  const auto result = sample({{0, 0}, {10, 0}, {10, 5}}, false, 2.5, 0.1);
  ASSERT_EQ(result.points.size(), 7U);
  EXPECT_LT((result.points[4] - Point<2>(10, 0)).norm(), 1e-12);
  EXPECT_LT((result.points[2] - Point<2>(5, 0)).norm(), 1e-12);
  EXPECT_EQ(result.largest_offset, 0);
  EXPECT_NEAR(result.largest_turn_deg, 90, 1e-10);
}

TEST(CurveSampling, PolygonsOfTheWantedEdgesStayAsTheyAre) {
  const Polyline polygon = testing::regular_polygon({3, 4}, 5, 16);  // edges of 1.95
  const auto result = sample(polygon, true, 2, 0.01);
  ASSERT_EQ(result.points.size(), 16U);
  for (const auto& p : result.points) EXPECT_LT(distance_to_polyline(polygon, true, p), 1e-12);
  EXPECT_LT(result.largest_offset, 1e-12);
}

TEST(CurveSampling, DenseCircleGetsEvenEdgesWithinTolerance) {
  const Polyline circle = testing::regular_polygon({0, 0}, 10, 400);
  const auto result = sample(circle, true, 3, 0.2);
  EXPECT_GE(result.points.size(), 20U);
  EXPECT_LE(result.points.size(), 24U);
  EXPECT_LT(result.largest_offset, 0.2);
  double shortest = 1e9, longest = 0;
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    const double e = (result.points[(i + 1) % result.points.size()] - result.points[i]).norm();
    shortest = std::min(shortest, e);
    longest = std::max(longest, e);
  }
  EXPECT_LT(longest, 1.1 * shortest);
}

TEST(CurveSampling, SharpCornersOfDenseCurvesAreHit) {
  Polyline square;
  const Polyline corners = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  for (int c = 0; c < 4; ++c) {
    for (int k = 0; k < 50; ++k) {
      square.push_back(corners[c] + k / 50.0 * (corners[(c + 1) % 4] - corners[c]));
    }
  }
  std::rotate(square.begin(), square.begin() + 23, square.end());
  const auto result = sample(square, true, 3, 0.05);
  for (const auto& corner : corners) {
    EXPECT_LT(distance_to_polyline(result.points, true, corner), 0.051);
  }
  EXPECT_LT(result.points.size(), 36U);
}

TEST(CurveSampling, KeepAreaBalancesChords) {
  const Polyline circle = testing::regular_polygon({0, 0}, 10, 1000);
  const double area = signed_area(circle);
  const auto plain = sample(circle, true, 4, 0.3);
  const auto kept = sample(circle, true, 4, 0.3, /*keep_area=*/true);
  EXPECT_LT(signed_area(plain.points) / area, 0.98);
  EXPECT_NEAR(signed_area(kept.points) / area, 1, 1e-3);
  EXPECT_LT(kept.largest_offset, 0.75 * plain.largest_offset);
}

TEST(CurveSampling, CurvedPartsGetMorePoints) {
  Polyline hook;  // straight, then a half circle of radius 2
  for (int i = 0; i <= 100; ++i) hook.emplace_back(-20 + 0.2 * i, 2);
  for (int i = 1; i <= 100; ++i) {
    const double angle = std::numbers::pi * (0.5 - i / 100.0);
    hook.emplace_back(2 * std::cos(angle), 2 * std::sin(angle));
  }
  const auto result = sample(hook, false, 4, 0.1);
  int on_circle = 0;
  for (const auto& p : result.points) on_circle += p.x() > 0.01;
  EXPECT_GE(on_circle, 4);
  EXPECT_LE(result.points.size(), 16U);
  EXPECT_LT(result.largest_turn_deg, 60);
  EXPECT_LT(result.largest_offset, 0.15);
}

TEST(CurveSampling, PixelStairsAreRecognised) {
  Polyline stairs;
  for (int i = 0; i < 10; ++i) {
    stairs.emplace_back(i, i);
    stairs.emplace_back(i + 1, i);
  }
  EXPECT_TRUE(looks_like_pixel_stairs(stairs, false));
  EXPECT_FALSE(looks_like_pixel_stairs(testing::regular_polygon({0, 0}, 5, 16), true));
  EXPECT_FALSE(looks_like_pixel_stairs(testing::regular_polygon({0, 0}, 5, 4), true));
}

}  // namespace crease
