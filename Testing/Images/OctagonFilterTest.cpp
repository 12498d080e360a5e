#include "Images/OctagonFilter.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "Core/Error.h"

namespace crease {
namespace {

constexpr int kSize = 81, kMiddle = 40;

Mask<2> empty_mask() {
  Raster<2> raster;
  raster.size = {kSize, kSize};
  return Mask<2>(raster);
}

/// |x|, |y| <= r and |x| + |y| <= sum about the middle.
Mask<2> octagon(int r, int sum) {
  Mask<2> mask = empty_mask();
  for (int j = 0; j < kSize; ++j) {
    for (int i = 0; i < kSize; ++i) {
      const int x = std::abs(i - kMiddle), y = std::abs(j - kMiddle);
      mask(i, j) = x <= r && y <= r && x + y <= sum;
    }
  }
  return mask;
}

TEST(OctagonFilter, OpeningKeepsTheOctagonAndNothingSmaller) {
  for (const auto& [radius, sum] : {std::pair(10, 14), std::pair(20, 28), std::pair(5, 7)}) {
    Mask<2> mask = octagon(radius, sum);
    EXPECT_EQ(opened_by_octagon(mask, radius, Outside::kBackground).values(), mask.values());
    mask(kMiddle + radius, kMiddle + sum - radius) = 0;  // a corner
    EXPECT_EQ(opened_by_octagon(mask, radius, Outside::kBackground).values(),
              empty_mask().values());
  }
}

TEST(OctagonFilter, ClosingFillsTheOctagonAndNothingLarger) {
  Mask<2> hole = octagon(10, 14), larger = octagon(10, 14);
  larger(kMiddle, kMiddle + 11) = 1;
  for (auto* mask : {&hole, &larger}) {
    for (auto& v : mask->values()) v = 1 - v;
  }
  EXPECT_EQ(closed_by_octagon(hole, 10, Outside::kBackground).values(), hole.values());
  Mask<2> smaller = hole;
  smaller(kMiddle + 10, kMiddle) = 1;
  EXPECT_EQ(closed_by_octagon(smaller, 10, Outside::kBackground)(kMiddle, kMiddle), 1);
  EXPECT_EQ(closed_by_octagon(larger, 10, Outside::kBackground).values(), hole.values());
}

TEST(OctagonFilter, BeyondTheBorderIsWhatIsSaid) {
  Mask<2> band = empty_mask();  // 5 columns at the left edge
  for (int j = 0; j < kSize; ++j) {
    for (int i = 0; i < 5; ++i) band(i, j) = 1;
  }
  EXPECT_EQ(opened_by_octagon(band, 10, Outside::kForeground).values(), band.values());
  EXPECT_EQ(opened_by_octagon(band, 10, Outside::kBackground).values(), empty_mask().values());
  EXPECT_EQ(closed_by_octagon(band, 10, Outside::kBackground).values(), band.values());
}

TEST(OctagonFilter, RefusesRadiiBelowAPixel) {
  EXPECT_THROW(opened_by_octagon(empty_mask(), 0, Outside::kBackground), InvalidInput);
}

}  // namespace
}  // namespace crease
