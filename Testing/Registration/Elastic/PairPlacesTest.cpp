#include "Registration/Elastic/PairPlaces.h"

#include <gmock/gmock.h>

#include "Core/Error.h"
#include "Testing/Transforms/SampleBases.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

const RegionOfInterest& body() {
  static const RegionOfInterest square({{{0, 0}, {100, 0}, {100, 100}, {0, 100}}});
  return square;
}

/// A lattice of pairs that all move by (3, 1) mm.
Landmarks<2> shifted_pairs() {
  Landmarks<2> pairs;
  for (double y : {20.0, 50.0, 80.0}) {
    for (double x : {20.0, 50.0, 80.0}) {
      pairs.fixed.emplace_back(x, y);
      pairs.moving.emplace_back(x + 3, y + 1);
    }
  }
  return pairs;
}

}  // namespace

// The partner moves along: what is asked of the tissue is the same displacement.
TEST(PlaceOnBorder, KeepsDisplacements) {
  auto pairs = shifted_pairs();
  pairs.fixed[0] = {-0.4, 40};
  pairs.fixed[1] = {60, -3};
  const auto basis = testing::triangles_over(body().bounds(), {.degree = 2}, 4);
  auto placed = pairs;
  place_on_border(placed, {0, 1, 2, 3, 4, 5, 6, 7}, *basis, 0.5);
  EXPECT_LT((placed.fixed[0] - Point<2>(0, 40)).norm(), 1e-9);
  EXPECT_LT((placed.moving[0] - pairs.moving[0] - Vector<2>(0.4, 0)).norm(), 1e-9);
  EXPECT_TRUE(basis->contains(placed.fixed[0]));
  EXPECT_EQ(placed.fixed[1], pairs.fixed[1]);  // too far
  EXPECT_EQ(placed.fixed[2], pairs.fixed[2]);
}

TEST(SnapMovingPoints, MovesThoseJustOutsideAndRefusesOthers) {
  auto pairs = shifted_pairs();
  EXPECT_THAT(snap_moving_points(pairs, body()), IsEmpty());
  EXPECT_EQ(pairs.moving, shifted_pairs().moving);
  pairs.moving[3] = {-1.5, 50};
  const auto warnings = snap_moving_points(pairs, body());
  ASSERT_EQ(warnings.size(), 1);
  EXPECT_THAT(warnings[0], HasSubstr("pair 4: the moving point (-1.50, 50.00) mm lay 1.50 mm"));
  EXPECT_LT((pairs.moving[3] - Point<2>(0, 50)).norm(), 1e-12);
  pairs.moving[3] = {-0.3, 50};
  pairs.moving[6] = {-0.2, 70};
  EXPECT_THAT(
      snap_moving_points(pairs, body()),
      ::testing::ElementsAre(HasSubstr("2 of the moving points lay up to 0.30 mm outside")));
  pairs.names.assign(9, "");
  pairs.names[8] = "nipple";
  pairs.moving[8] = {110, 80};
  EXPECT_THAT([&] { snap_moving_points(pairs, body()); },
              ThrowsMessage<InvalidInput>(HasSubstr("pair 9 (nipple)")));
}

// What somebody has seen outweighs what was found by arc length, in whichever image they meet.
TEST(ContourPairsAtOthers, AreLeftOut) {
  auto pairs = shifted_pairs();
  std::vector<int> contour = {0, 1, 2, 5};
  EXPECT_THAT(leave_out_found_pairs(pairs, contour), IsEmpty());
  EXPECT_EQ(pairs.size(), 9);

  pairs.names = {"contour 1", "contour 2", "contour 3", "", "", "contour 4", "", "", ""};
  pairs.fixed[4] = pairs.fixed[1] + Vector<2>(0, 1.9);
  pairs.fixed[8] = pairs.fixed[2] + Vector<2>(0, 2.1);
  pairs.moving[6] = pairs.moving[5] + Vector<2>(1, 0);
  const auto before = pairs;
  const auto warnings = leave_out_found_pairs(pairs, contour);
  EXPECT_THAT(warnings,
              ::testing::ElementsAre(
                  HasSubstr("pair 5 lies 1.90 mm from pair 2 (contour 2) in the fixed image"),
                  HasSubstr("pair 7 lies 1.00 mm from pair 6 (contour 4) in the moving image")));
  EXPECT_THAT(contour, ::testing::ElementsAre(0, 1));
  ASSERT_EQ(pairs.size(), 7);
  EXPECT_EQ(pairs.names[1], "contour 3");
  EXPECT_EQ(pairs.fixed[1], before.fixed[2]);
  EXPECT_EQ(pairs.moving[4], before.moving[6]);
}

TEST(StrangePairs, DifferByMoreThanThreeTenthsOfTheWidth) {
  for (const double share : {0.29, 0.31}) {
    auto pairs = shifted_pairs();
    pairs.moving[4] += 100 * share * Vector<2>(0.6, -0.8);
    EXPECT_EQ(strange_pairs(pairs, 100).size(), share > 0.3 ? 1 : 0) << share;
  }
}

TEST(StrangePairs, AreThoseUnlikeTheirNeighbours) {
  auto pairs = shifted_pairs();
  EXPECT_THAT(strange_pairs(pairs, 100), IsEmpty());
  pairs.moving[5] = {99, 99};
  const auto warnings = strange_pairs(pairs, 100);
  ASSERT_EQ(warnings.size(), 1);
  EXPECT_THAT(warnings[0], HasSubstr("pair 6 at (80.00, 50.00) mm"));
  EXPECT_THAT(strange_pairs(pairs, 1000), IsEmpty());
}

}  // namespace crease
