#include "Registration/Mammogram/ContourPairs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "Core/Error.h"
#include "Testing/Registration/Mammogram/DrawnBreast.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const Polyline kStraight = {{0, 0}, {30, 0}, {100, 0}};
const Polyline kCorner = {{0, 0}, {0, 120}, {80, 120}};

TEST(ContourPairs, LieAtEqualSharesOfTheLength) {
  const ContourPairs pairs = contour_pairs(kStraight, kCorner, {}, {}, {.count = 5});
  ASSERT_EQ(pairs.landmarks.size(), 5);
  const Polyline fixed = {{0, 0}, {25, 0}, {50, 0}, {75, 0}, {100, 0}};
  const Polyline moving = {{0, 0}, {0, 50}, {0, 100}, {30, 120}, {80, 120}};
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_LT((pairs.landmarks.fixed[k] - fixed[k]).norm(), 1e-12);
    EXPECT_LT((pairs.landmarks.moving[k] - moving[k]).norm(), 1e-12);
  }
  EXPECT_EQ(pairs.fixed_length_mm, 100);
  EXPECT_EQ(pairs.moving_length_mm, 200);
  EXPECT_FALSE(pairs.nipple_used);
}

TEST(ContourPairs, TheNippleSplitsTheLength) {
  const ContourPairs pairs =
      contour_pairs(kStraight, kCorner, Point<2>(40, 3), Point<2>(-1, 120), {.count = 11});
  EXPECT_TRUE(pairs.nipple_used);
  ASSERT_EQ(pairs.landmarks.names[5], "nipple");  // shares 0.4 and 0.6
  EXPECT_LT((pairs.landmarks.fixed[5] - Point<2>(40, 0)).norm(), 1e-12);
  EXPECT_LT((pairs.landmarks.moving[5] - Point<2>(0, 120)).norm(), 1e-12);
  EXPECT_LT((pairs.landmarks.fixed[1] - Point<2>(8, 0)).norm(), 1e-12);
  EXPECT_LT((pairs.landmarks.moving[1] - Point<2>(0, 24)).norm(), 1e-12);
  EXPECT_LT((pairs.landmarks.fixed[6] - Point<2>(52, 0)).norm(), 1e-12);
  EXPECT_LT((pairs.landmarks.moving[10] - Point<2>(80, 120)).norm(), 1e-12);
  const ContourPairs one =
      contour_pairs(kStraight, kCorner, Point<2>(40, 3), std::nullopt, {.count = 11});
  EXPECT_FALSE(one.nipple_used);
  EXPECT_FALSE(contour_pairs(kStraight, kCorner, Point<2>(40, 3), Point<2>(-1, 120),
                             {.count = 11, .use_nipples = false})
                   .nipple_used);
}

// Known pairs on the contours split them; others say nothing.
TEST(ContourPairs, PassThroughKnownPairs) {
  ContourPairOptions options{.count = 11};
  options.known.fixed = {{40, 1}, {50, 30}, {70, 0}};
  options.known.moving = {{0, 60}, {0, 70}, {0, 30}};  // the last would fold
  const ContourPairs pairs = contour_pairs(kStraight, kCorner, {}, {}, options);
  EXPECT_EQ(pairs.num_anchors, 1);
  ASSERT_EQ(pairs.landmarks.size(), 11);
  for (std::size_t k = 0; k < 11; ++k) {  // the number of the knot is 3.5: shares of 0.4 and 0.3
    const Point<2>&p = pairs.landmarks.fixed[k], &q = pairs.landmarks.moving[k];
    const double along = q.y() < 120 ? q.y() : 120 + q.x();
    const double expected = p.x() < 40 ? 1.5 * p.x() : 60 + (p.x() - 40) / 60 * 140;
    EXPECT_NEAR(along, expected, 1e-9) << k;
  }
}

// The film may cut two contours at different places: near known pairs lengths count, not shares.
TEST(ContourPairs, GoOnEquallyFarBeyondKnownPairsNearTheEnds) {
  const Polyline cut = {{0, 0}, {0, 90}};
  ContourPairOptions options{.count = 21};
  options.known.fixed = {{10, 0}, {90, 0}};
  options.known.moving = {{0, 5}, {0, 85}};
  const ContourPairs pairs = contour_pairs(kStraight, cut, {}, {}, options);
  EXPECT_EQ(pairs.num_anchors, 2);
  EXPECT_LT(pairs.landmarks.size(), 21);
  EXPECT_GT(pairs.landmarks.size(), 17);
  for (std::size_t k = 0; k < pairs.landmarks.fixed.size(); ++k) {
    EXPECT_NEAR(pairs.landmarks.moving[k].y(), pairs.landmarks.fixed[k].x() - 5, 1e-9) << k;
  }
}

TEST(ContourPairs, FollowAStretch) {
  const ContourPairs pairs = contour_pairs(kStraight, kStraight, {}, {},
                                           {.count = 3, .stretch = [](double t) { return t * t; }});
  EXPECT_LT((pairs.landmarks.fixed[1] - Point<2>(50, 0)).norm(), 1e-12);
  EXPECT_LT((pairs.landmarks.moving[1] - Point<2>(25, 0)).norm(), 1e-12);
}

TEST(ContourPairs, RefuseWhatCannotBePaired) {
  const auto refused = [](const Polyline& contour, const ContourPairOptions& options,
                          const char* reason) {
    EXPECT_THAT([&] { contour_pairs(kStraight, contour, {}, {}, options); },
                ThrowsMessage<InvalidInput>(HasSubstr(reason)));
  };
  refused(kCorner, {.count = 2}, "at least 3");
  refused({}, {}, "moving image is empty");
  refused({{1, 1}, {1, 1}}, {}, "moving image is empty");
  refused(kCorner, {.stretch = [](double t) { return std::sin(6 * t); }}, "grow from 0 to 1");
  refused(kCorner, {.stretch = [](double t) { return 0.2 + 0.5 * t; }}, "grow from 0 to 1");
}

// One breast, and the same 10 % larger: every pair differs by that factor about the chest wall's middle.
TEST(ContourPairs, OfSimilarBreastsAreSimilar) {
  const auto drawn = testing::draw_breast({.label = false});
  Raster<2> larger = drawn.image.raster();
  larger.spacing *= 1.1;
  const MammogramAnatomy fixed = analyse_mammogram(drawn.image);
  const MammogramAnatomy moving = analyse_mammogram(Image<float, 2>(larger, drawn.image.values()));
  const ContourPairs pairs = contour_pairs(fixed, moving);
  ASSERT_EQ(pairs.landmarks.size(), 40);
  EXPECT_TRUE(pairs.nipple_used);
  for (std::size_t k = 0; k < 40; ++k) {
    EXPECT_LT((pairs.landmarks.moving[k] - 1.1 * pairs.landmarks.fixed[k]).norm(), 1.0) << k;
  }
}

TEST(ContourPairs, BeginAtThePectoralLine) {
  const auto drawn = testing::draw_breast({.pectoral = true});
  const MammogramAnatomy anatomy = analyse_mammogram(drawn.image);
  ASSERT_TRUE(anatomy.pectoral.has_value());
  const Polyline contour = anatomy.contour_below_pectoral();
  EXPECT_LT(distance_to_polyline(anatomy.pectoral->line, false, contour.front()), 1.0);
  EXPECT_LT(contour.size(), anatomy.skin.points.size());
  EXPECT_EQ(contour.back(), anatomy.skin.points.back());
}

}  // namespace
}  // namespace crease
