#include "Registration/Mammogram/SkinContour.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "Core/Error.h"
#include "Registration/Mammogram/BreastSegmentation.h"
#include "Testing/Registration/Mammogram/DrawnBreast.h"

namespace crease {
namespace {

using testing::draw_breast;
using testing::DrawnBreast;
using ::testing::HasSubstr;
using testing::mean_distance;
using ::testing::ThrowsMessage;

constexpr double kPi = std::numbers::pi;

Polyline circle(double radius, int turns_way, int count) {
  Polyline points;
  for (int k = 0; k < count; ++k) {
    const double angle = turns_way * 2 * kPi * k / (count - 1);
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return points;
}

// c(t) = kappa L = 2 pi all along, positive from +x towards +y.
TEST(SkinContour, CurvatureOfACircleIsTwoPi) {
  for (const int way : {1, -1}) {
    for (const double radius : {20.0, 90.0}) {
      const SkinContour contour =
          smooth_contour(circle(radius, way, 2000), {.smoothing_mm = 0.001});
      for (const double c : contour.curvature) EXPECT_NEAR(c, way * 2 * kPi, 0.02 * 2 * kPi);
    }
  }
}

// Pixels of a disc at the left edge: c = pi along the half circle, on average over the stairs.
TEST(SkinContour, CurvatureOfADrawnHalfDiscIsPi) {
  Raster<2> raster;
  raster.size = {400, 700};
  raster.spacing.setConstant(0.2);
  Mask<2> mask(raster);
  for (int j = 0; j < 700; ++j) {
    for (int i = 0; i < 400; ++i) mask(i, j) = std::hypot(i, j - 350) <= 300;
  }
  const SkinContour contour = find_skin_contour(mask);
  EXPECT_NEAR(contour.length_mm, kPi * 60, 0.01 * kPi * 60);
  double sum = 0;
  for (const double c : contour.curvature) sum += c / static_cast<double>(contour.curvature.size());
  EXPECT_NEAR(sum, kPi, 0.03 * kPi);
}

TEST(SkinContour, FollowsTheOutlineDownwards) {
  for (const bool nipple : {true, false}) {
    const DrawnBreast drawn = draw_breast({.nipple = nipple});
    const SkinContour contour = find_skin_contour(drawn.mask);
    EXPECT_LT(mean_distance(contour.points, drawn.outline), 0.3);  // 1.5 pixels
    EXPECT_LE(contour.rms_mm, 0.4);
    EXPECT_EQ(contour.points.size(), 512u);
    EXPECT_LT(contour.points.front().y(), contour.points.back().y());
    EXPECT_NEAR(contour.length_mm, polyline_length(drawn.outline, false), 0.02 * contour.length_mm);
    double turned =
        0;  // a contour that is walked downwards round a breast on the right turns by pi
    for (const double c : contour.curvature) turned += c / 511;
    EXPECT_NEAR(turned, kPi, 0.5);
  }
}

TEST(SkinContour, OfThePredictedMaskIsNearTheOutline) {
  for (const double noise : {0.004, 0.015}) {
    const DrawnBreast drawn = draw_breast({.noise = noise});
    const SkinContour contour = find_skin_contour(segment_breast(drawn.image).mask);
    EXPECT_LT(mean_distance(contour.points, drawn.outline), 0.3) << noise;
  }
}

TEST(SkinContour, MirrorImagesHaveOppositeCurvature) {
  const DrawnBreast drawn = draw_breast();
  const SkinContour one = find_skin_contour(drawn.mask);
  const SkinContour other = find_skin_contour(testing::flipped(drawn.mask));
  ASSERT_EQ(one.num_control_points, other.num_control_points);
  for (std::size_t i = 0; i < one.curvature.size(); ++i) {
    EXPECT_NEAR(one.curvature[i], -other.curvature[i], 1e-6);
  }
}

TEST(SkinContour, LeavesOutWhatRunsAlongTheFrame) {
  const DrawnBreast drawn = draw_breast({.height = 480, .label = false});  // cut above and below
  const SkinContour contour = find_skin_contour(drawn.mask);
  for (const auto& p : contour.points) {
    EXPECT_GT(p.y(), -0.2);
    EXPECT_LT(p.y(), 96.2);
    EXPECT_GT(p.x(), 20);
  }
  EXPECT_GE(contour.rest.size(), 4u);  // two corners of the frame among them
}

TEST(SkinContour, FindsTheNippleWhereItIs) {
  const DrawnBreast drawn = draw_breast();
  const SkinContour contour = find_skin_contour(drawn.mask);
  ASSERT_TRUE(contour.nipple.has_value());
  EXPECT_LT((contour.nipple->point - drawn.nipple).norm(), 1.5);
  const auto tip = contour.points[static_cast<std::size_t>(std::lround(511 * contour.nipple->t))];
  EXPECT_LT((contour.nipple->point - tip).norm(), 3);
  EXPECT_FALSE(find_skin_contour(draw_breast({.nipple = false}).mask).nipple.has_value());
}

TEST(SkinContour, RefusesShortContoursUnlessForced) {
  Polyline points = circle(8, 1, 300);  // 50 mm
  EXPECT_THAT([&] { smooth_contour(points, {.name = "film.png"}); },
              ThrowsMessage<InvalidInput>(::testing::AllOf(
                  HasSubstr("film.png"), HasSubstr("50 mm"), HasSubstr("--force"))));
  EXPECT_NEAR(smooth_contour(points, {.force = true}).length_mm, 16 * kPi, 1);
  Raster<2> raster;
  raster.size = {200, 200};
  EXPECT_THROW(find_skin_contour(Mask<2>(raster)), InvalidInput);
  EXPECT_THROW(find_skin_contour(Mask<2>(raster, 1)), InvalidInput);
}

}  // namespace
}  // namespace crease
