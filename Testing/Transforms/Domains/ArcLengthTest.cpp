#include "Transforms/Domains/ArcLength.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace crease {
namespace {

using ::testing::ElementsAre;

const Polyline kSteps = {{0, 0}, {3, 0}, {3, 4}, {3, 4}, {1, 4}};  // one point stands twice

TEST(ArcLength, AddsUpTheEdges) {
  const std::vector<double> lengths = arc_lengths(kSteps);
  EXPECT_THAT(lengths, ElementsAre(0, 3, 7, 7, 9));
  EXPECT_DOUBLE_EQ(lengths.back(), polyline_length(kSteps, false));
  EXPECT_THAT(arc_lengths(Polyline{}), ElementsAre());
}

TEST(ArcLength, FindsThePointAfterALength) {
  const std::vector<double> lengths = arc_lengths(kSteps);
  const auto at = [&](double length) { return point_at_length(kSteps, lengths, length); };
  EXPECT_EQ(at(0), Point<2>(0, 0));
  EXPECT_EQ(at(1.5), Point<2>(1.5, 0));
  EXPECT_EQ(at(7), Point<2>(3, 4));
  EXPECT_EQ(at(8), Point<2>(2, 4));
  EXPECT_EQ(at(9), Point<2>(1, 4));
}

TEST(ArcLength, LengthsBeyondTheEndsBelongToTheEnds) {
  const std::vector<double> lengths = arc_lengths(kSteps);
  EXPECT_EQ(point_at_length(kSteps, lengths, -1), kSteps.front());
  EXPECT_EQ(point_at_length(kSteps, lengths, 10), kSteps.back());
  const PlaceBetween place = place_at_length(lengths, 5);
  EXPECT_EQ(place.first, 1u);
  EXPECT_DOUBLE_EQ(place.share, 0.5);
}

TEST(ArcLength, FindsTheNearestPlace) {
  const NearestPlace nearest = nearest_place(kSteps, false, {5, 1});
  EXPECT_DOUBLE_EQ(nearest.distance, 2);
  EXPECT_DOUBLE_EQ(nearest.length, 4);
  EXPECT_EQ(nearest.point, Point<2>(3, 1));
}

// The point lies beside the edge from the last point to the first, which an open polyline has not.
TEST(ArcLength, ClosedPolylinesHaveAnEdgeMore) {
  const Polyline square = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
  const NearestPlace closed = nearest_place(square, true, {-1, 0.5});
  EXPECT_DOUBLE_EQ(closed.distance, 1);
  EXPECT_DOUBLE_EQ(closed.length, 7.5);
  EXPECT_DOUBLE_EQ(nearest_place(square, false, {-1, 0.5}).distance, std::hypot(1, 0.5));
}

TEST(ArcLength, NothingIsNearWithoutAnEdge) {
  EXPECT_TRUE(std::isinf(nearest_place(Polyline{}, false, {0, 0}).distance));
  EXPECT_TRUE(std::isinf(nearest_place(Polyline{{1, 1}}, false, {0, 0}).distance));
}

}  // namespace
}  // namespace crease
