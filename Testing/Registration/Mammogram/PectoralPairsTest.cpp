#include "Registration/Mammogram/PectoralPairs.h"

#include <gtest/gtest.h>

#include "Testing/Registration/Mammogram/DrawnBreast.h"

namespace crease {
namespace {

TEST(PectoralPairs, LieEquallyFarFromTheSkin) {
  const Polyline fixed = {{60, 0}, {60, 30}, {20, 60}};           // 30 + 50 mm
  const Polyline moving = {{50, 5}, {50, 50}, {0, 50}, {0, 60}};  // 45 + 50 + 10 mm
  const auto pairs = pectoral_pairs(fixed, moving, 2);            // at 32 and 64 of 80 mm
  ASSERT_EQ(pairs.size(), 2);
  EXPECT_LT((pairs.fixed[0] - Point<2>(58.4, 31.2)).norm(), 1e-12);
  EXPECT_LT((pairs.moving[0] - Point<2>(50, 37)).norm(), 1e-12);
  EXPECT_LT((pairs.fixed[1] - Point<2>(32.8, 50.4)).norm(), 1e-12);
  EXPECT_LT((pairs.moving[1] - Point<2>(31, 50)).norm(), 1e-12);
  EXPECT_EQ(pairs.names[1], "pectoral 2");
}

TEST(PectoralPairs, NeedTheMuscleInBothImages) {
  const MammogramAnatomy with = analyse_mammogram(testing::draw_breast({.pectoral = true}).image);
  MammogramAnatomy other = with;
  EXPECT_EQ(pectoral_pairs(with, other).size(), 4);
  other.pectoral->line.front() += Vector<2>(0, 10);  // a line of the user's that begins elsewhere
  EXPECT_EQ(pectoral_pairs(with, other).size(), 0);
  other.pectoral.reset();
  EXPECT_EQ(pectoral_pairs(with, other).size(), 0);
  EXPECT_EQ(pectoral_pairs(other, with).size(), 0);
}

}  // namespace
}  // namespace crease
