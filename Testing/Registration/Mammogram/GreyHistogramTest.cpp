#include "Registration/Mammogram/GreyHistogram.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "Registration/Phantoms/Random.h"

namespace crease {
namespace {

Image<float, 2> image_of(const std::vector<float>& values) {
  Raster<2> raster;
  raster.size = {static_cast<int>(values.size()), 1};
  return {raster, values};
}

/// Whole numbers: 60,000 about 20 (deviation 4) and 40,000 about 140 (deviation 30), within 0 .. 255.
std::vector<float> two_classes() {
  Random random(5, 1);
  std::vector<float> values = {0, 255};
  for (int k = 0; k < 100000; ++k) {
    const double v = k < 60000 ? 20 + 4 * random.normal() : 140 + 30 * random.normal();
    values.push_back(static_cast<float>(std::clamp(std::round(v), 0.0, 255.0)));
  }
  return values;
}

TEST(GreyHistogram, FindsTheValleyBesideTheBackground) {
  const GreyHistogram histogram = grey_histogram(image_of(two_classes()));
  EXPECT_NEAR(histogram.grey_value(histogram.background - 0.5), 20, 2);
  ASSERT_TRUE(histogram.valley.has_value());
  // Five deviations above the background hardly a pixel is left, and the other class begins at 40.
  EXPECT_GT(histogram.grey_value(*histogram.valley), 32);
  EXPECT_LT(histogram.grey_value(*histogram.valley), 60);
  EXPECT_GT(histogram.otsu, *histogram.valley);
  EXPECT_EQ(histogram.threshold(), *histogram.valley);
}

// The same image with 8 of 16 bits, shifted to the top, and in a part of the range.
TEST(GreyHistogram, DoesNotDependOnTheBitDepth) {
  const auto values = two_classes();
  const GreyHistogram plain = grey_histogram(image_of(values));
  for (const float scale : {16.0f, 257.0f}) {
    auto scaled = values;
    for (float& v : scaled) v = 100 + scale * v;
    const GreyHistogram other = grey_histogram(image_of(scaled));
    for (int t = 0; t < GreyHistogram::kBins; ++t) {
      EXPECT_NEAR(other.counts[t], plain.counts[t], 1e-6);  // shares of a level, rounded
    }
    EXPECT_EQ(other.valley, plain.valley);
    EXPECT_NEAR(other.grey_value(other.threshold()),
                100 + scale * plain.grey_value(plain.threshold()), 1e-6 * scale);
  }
}

// 101 grey values on 256 bins would leave most bins empty, each a valley of its own.
TEST(GreyHistogram, LeavesNoBinEmptyBetweenCoarseValues) {
  auto values = two_classes();
  for (float& v : values) v = std::round(v * 100 / 255);
  const GreyHistogram histogram = grey_histogram(image_of(values));
  const double total = std::accumulate(histogram.counts.begin(), histogram.counts.end(), 0.0);
  EXPECT_NEAR(total, static_cast<double>(values.size()), 1e-6);
  ASSERT_TRUE(histogram.valley.has_value());
  EXPECT_GT(histogram.grey_value(*histogram.valley), 12);
  EXPECT_LT(histogram.grey_value(*histogram.valley), 24);
}

TEST(GreyHistogram, WithoutAValleyTakesOtsusThreshold) {
  std::vector<float> values;  // falls evenly from the background on
  for (int v = 0; v < 256; ++v)
    values.insert(values.end(), static_cast<std::size_t>(3 * (300 - v)), v);
  const GreyHistogram histogram = grey_histogram(image_of(values));
  EXPECT_FALSE(histogram.valley.has_value());
  EXPECT_EQ(histogram.threshold(), histogram.otsu);
}

// Two equal groups: every threshold between them separates them best, the first is taken.
TEST(GreyHistogram, OtsuSeparatesTwoGroups) {
  std::vector<float> values(500, 10.0f);
  values.insert(values.end(), 500, 200.0f);
  const GreyHistogram histogram = grey_histogram(image_of(values));
  EXPECT_GE(histogram.grey_value(histogram.otsu), 10);
  EXPECT_LT(histogram.grey_value(histogram.otsu), 200);
}

TEST(GreyHistogram, OneGreyValueIsAnEmptyRange) {
  const GreyHistogram histogram = grey_histogram(image_of(std::vector<float>(50, 7.0f)));
  EXPECT_EQ(histogram.lower, histogram.upper);
  EXPECT_EQ(grey_histogram({}).counts[0], 0);
}

}  // namespace
}  // namespace crease
