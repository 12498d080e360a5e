#include "Registration/Mammogram/PectoralMuscle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "Core/Error.h"
#include "Testing/Registration/Mammogram/DrawnBreast.h"

namespace crease {
namespace {

using testing::draw_breast;
using testing::DrawnBreast;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(PectoralMuscle, IsFoundInObliqueViews) {
  for (const double noise : {0.004, 0.015}) {
    const DrawnBreast drawn = draw_breast({.noise = noise, .pectoral = true});
    const auto muscle = find_pectoral_muscle(drawn.image, segment_breast(drawn.image));
    ASSERT_TRUE(muscle.has_value()) << noise;
    EXPECT_GT(muscle->contrast, 2);
    EXPECT_LT(testing::mean_distance(muscle->line, drawn.pectoral), 0.5) << noise;
    EXPECT_LT(muscle->line.front().y(), muscle->line.back().y());
    EXPECT_LT(muscle->line.back().x(), 0.5);  // at the chest wall
    EXPECT_EQ(std::ranges::adjacent_find(muscle->line), muscle->line.end());
  }
}

TEST(PectoralMuscle, OfTheMirrorImageIsTheMirrorImage) {
  const DrawnBreast drawn = draw_breast({.pectoral = true});
  const auto image = testing::flipped(drawn.image);
  const auto one = find_pectoral_muscle(drawn.image, segment_breast(drawn.image));
  const auto other = find_pectoral_muscle(image, segment_breast(image));
  ASSERT_TRUE(one && other);
  ASSERT_EQ(one->line.size(), other->line.size());
  for (std::size_t i = 0; i < one->line.size(); ++i) {
    const Point<2> p(559 * 0.2 - other->line[i].x(), other->line[i].y());
    EXPECT_LT((p - one->line[i]).norm(), 1e-3);
  }
}

TEST(PectoralMuscle, IsNotFoundWhereThereIsNone) {
  for (const double noise : {0.004, 0.015}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const DrawnBreast drawn = draw_breast({.noise = noise, .seed = seed});
      EXPECT_FALSE(find_pectoral_muscle(drawn.image, segment_breast(drawn.image)).has_value());
    }
  }
}

TEST(PectoralMuscle, TakesTheUsersLineUpperEndFirst) {
  const DrawnBreast drawn = draw_breast({.pectoral = true});
  const BreastSegmentation breast = segment_breast(drawn.image);
  Polyline line = drawn.pectoral;
  std::reverse(line.begin(), line.end());
  const PectoralMuscle muscle = pectoral_muscle_of(line, drawn.image, breast);
  EXPECT_TRUE(muscle.given);
  EXPECT_EQ(muscle.line.front(), drawn.pectoral.front());
  EXPECT_GT(muscle.contrast, 2);
  for (auto& p : line) p.x() += 12;  // beside the edge
  EXPECT_LT(pectoral_muscle_of(line, drawn.image, breast).contrast, 1);
}

TEST(PectoralMuscle, RefusesLinesThatCannotBe) {
  const DrawnBreast drawn = draw_breast();
  const BreastSegmentation breast = segment_breast(drawn.image);
  const auto refused = [&](const Polyline& line, const char* reason) {
    EXPECT_THAT([&] { pectoral_muscle_of(line, drawn.image, breast); },
                ThrowsMessage<InvalidInput>(HasSubstr(reason)));
  };
  refused({{1, 2}}, "2 points");
  refused({{1, 40}, {std::numeric_limits<double>::infinity(), 3}}, "point 2");
  refused({{-500, 2}, {-500, 30}}, "none of its points");
}

}  // namespace
}  // namespace crease
