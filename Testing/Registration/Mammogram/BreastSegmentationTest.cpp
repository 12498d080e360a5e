#include "Registration/Mammogram/BreastSegmentation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Testing/Registration/Mammogram/DrawnBreast.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using testing::dice;
using testing::draw_breast;
using testing::DrawnBreast;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

TEST(BreastSegmentation, FindsDrawnBreasts) {
  for (const double noise : {0.004, 0.015}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const DrawnBreast drawn =
          draw_breast({.noise = noise, .pectoral = seed % 2 == 0, .seed = seed});
      const BreastSegmentation breast = segment_breast(drawn.image);
      EXPECT_GE(dice(breast.mask, drawn.mask), 0.99) << "noise " << noise << ", seed " << seed;
      EXPECT_EQ(breast.side, ChestSide::kLeft);
      EXPECT_THAT(breast.warnings, IsEmpty());
    }
  }
}

TEST(BreastSegmentation, DoesNotDependOnBitDepthOrSide) {
  for (const double noise : {0.004, 0.015}) {
    const DrawnBreast drawn = draw_breast({.noise = noise});
    const Mask<2> reference = segment_breast(testing::quantized(drawn.image, 65535)).mask;
    for (const int largest : {255, 4095}) {
      const auto image = testing::quantized(drawn.image, largest);
      EXPECT_GE(dice(segment_breast(image).mask, reference), 0.998) << largest;
    }
    const BreastSegmentation other = segment_breast(testing::flipped(drawn.image));
    EXPECT_GE(dice(testing::flipped(other.mask), reference), 0.998);
    EXPECT_EQ(other.side, ChestSide::kRight);
  }
}

TEST(BreastSegmentation, CountsTheArea) {
  const DrawnBreast drawn = draw_breast();
  double pixels = 0;
  for (const auto v : drawn.mask.values()) pixels += v;
  EXPECT_NEAR(segment_breast(drawn.image).area_mm2, pixels * 0.04, 0.01 * pixels * 0.04);
}

TEST(BreastSegmentation, CutsATouchingLabelOffAndSaysWhere) {
  DrawnBreast drawn = draw_breast({.label = false});
  // A plate of 30 x 7 mm that reaches 1 mm into the breast at its lower right.
  Point<2> corner = drawn.outline[1400];
  const int left = static_cast<int>(corner.x() / 0.2) - 5,
            top = static_cast<int>(corner.y() / 0.2) - 5;
  for (int j = top; j < top + 35; ++j) {
    for (int i = left; i < std::min(left + 150, drawn.image.size()[0]); ++i) {
      if (!drawn.mask(i, j)) drawn.image(i, j) = 0.95f;
    }
  }
  const BreastSegmentation breast = segment_breast(drawn.image);
  EXPECT_THAT(breast.warnings, Contains(AllOf(HasSubstr("label"), HasSubstr(" mm"))));
  EXPECT_GE(dice(breast.mask, drawn.mask), 0.985);
}

// The nipple stands out as a label does, but it is neither a rectangle nor bright.
TEST(BreastSegmentation, KeepsTheNipple) {
  const DrawnBreast drawn = draw_breast();
  const BreastSegmentation breast = segment_breast(drawn.image);
  const int i = static_cast<int>(drawn.nipple.x() / 0.2) - 5;
  const int j = static_cast<int>(drawn.nipple.y() / 0.2);
  EXPECT_EQ(breast.mask(i, j), 1);
}

TEST(BreastSegmentation, NotesWhereTheFilmCutsTheBreast) {
  const BreastSegmentation breast =
      segment_breast(draw_breast({.height = 480, .label = false}).image);
  EXPECT_TRUE(breast.cut_above);
  EXPECT_TRUE(breast.cut_below);
  EXPECT_THAT(breast.notes, Contains(HasSubstr("upper")));
  EXPECT_THAT(breast.notes, Contains(HasSubstr("lower")));
  EXPECT_THAT(segment_breast(draw_breast().image).notes, IsEmpty());
}

TEST(BreastSegmentation, TakesTheUsersThresholdOrMask) {
  const DrawnBreast drawn = draw_breast();
  const BreastSegmentation inner = segment_breast(drawn.image, {.threshold = 0.3});
  EXPECT_EQ(inner.threshold, 0.3);
  EXPECT_LT(inner.area_mm2, 0.97 * segment_breast(drawn.image).area_mm2);
  Mask<2> mask = drawn.mask;
  mask(100, 350) = 0;  // a hole
  mask(500, 10) = 1;   // a speck
  EXPECT_EQ(segmentation_of_mask(mask).mask.values(), drawn.mask.values());
}

void expect_no_breast(const Image<float, 2>& image, const char* reason,
                      BreastSegmentationOptions options = {}) {
  options.name = "film.png";
  EXPECT_THAT([&] { segment_breast(image, options); },
              ThrowsMessage<NoBreastFound>(AllOf(HasSubstr("no breast found in film.png"),
                                                 HasSubstr(reason), HasSubstr("--threshold"),
                                                 HasSubstr("--roi"))));
}

TEST(BreastSegmentation, SaysWhyThereIsNoBreast) {
  const DrawnBreast drawn = draw_breast();
  expect_no_breast(drawn.image, "touches the left or the right", {.threshold = 2.0});
  expect_no_breast(drawn.image, "touches both", {.threshold = 0.0, .largest_area = 1.0});
  expect_no_breast(drawn.image, "100 %", {.threshold = 0.0});
  expect_no_breast(drawn.image, "takes up", {.smallest_area = 0.8});
  Raster<2> raster;
  raster.size = {300, 300};
  expect_no_breast(Image<float, 2>(raster, 5.0f), "equal");
}

TEST(BreastSegmentation, FailuresOfferTheHistogram) {
  const DrawnBreast drawn = draw_breast();
  try {
    segment_breast(drawn.image, {.smallest_area = 0.8});
    FAIL() << "nothing was thrown";
  } catch (const NoBreastFound& error) {
    EXPECT_EQ(error.histogram.counts, grey_histogram(drawn.image).counts);
  }
}

}  // namespace
}  // namespace crease
