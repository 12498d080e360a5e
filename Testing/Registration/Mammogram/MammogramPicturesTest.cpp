#include "Registration/Mammogram/MammogramPictures.h"

#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Registration/Mammogram/ContourPairs.h"
#include "Testing/Registration/Mammogram/DrawnBreast.h"

namespace crease {
namespace {

int count(const Picture& picture, int red, int green, int blue) {
  int n = 0;
  for (std::size_t i = 0; i + 2 < picture.rgb.size(); i += 3) {
    n += picture.rgb[i] == red && picture.rgb[i + 1] == green && picture.rgb[i + 2] == blue;
  }
  return n;
}

TEST(MammogramPictures, OverlayShowsEveryLine) {
  const MammogramAnatomy anatomy =
      analyse_mammogram(testing::draw_breast({.pectoral = true}).image);
  const auto pairs = contour_pairs(anatomy, anatomy).landmarks.fixed;
  const Picture picture = overlay_contours({{"fixed", &anatomy, pairs}, {"moving", &anatomy}});
  EXPECT_EQ(picture.rgb.size(), std::size_t(picture.width) * picture.height * 3);
  EXPECT_GT(picture.width, 2 * 560);
  EXPECT_GT(count(picture, 255, 220, 60), 1000);  // skin line
  EXPECT_GT(count(picture, 255, 140, 0), 600);    // pectoral line
  EXPECT_GT(count(picture, 255, 60, 170), 20);    // nipple
  const Picture plain = overlay_contours({{"", &anatomy}});
  const int swatch = 22 * 22;
  EXPECT_LT(count(plain, 90, 230, 120), 10);  // no pairs: not even a swatch
  EXPECT_GT(count(picture, 90, 230, 120), swatch / 2);
  EXPECT_THROW(overlay_contours({}), InvalidInput);
}

TEST(MammogramPictures, HistogramMarksItsThresholds) {
  GreyHistogram histogram = grey_histogram(testing::draw_breast().image);
  const Picture with = histogram_picture(histogram);
  ASSERT_TRUE(histogram.valley.has_value());
  EXPECT_GT(count(with, 255, 60, 170), 200);
  histogram.valley.reset();
  EXPECT_EQ(count(histogram_picture(histogram), 255, 60, 170), 0);
  EXPECT_GT(histogram_picture(GreyHistogram{}).width, 0);
}

}  // namespace
}  // namespace crease
