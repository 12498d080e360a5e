#include "Registration/Mammogram/GreyScale.h"

#include <gtest/gtest.h>

namespace crease {
namespace {

/// Greys from 0 to `brightest` along the rows.
Image<float, 2> ramp(float brightest) {
  Raster<2> raster;
  raster.size = {101, 8};
  Image<float, 2> image(raster);
  for (int j = 0; j < 8; ++j) {
    for (int i = 0; i < 101; ++i) image(i, j) = brightest * static_cast<float>(i) / 100;
  }
  return image;
}

}  // namespace

TEST(GreyScale, BitDepthsDifferByPowersOfTwo) {
  EXPECT_EQ(bit_depth_ratio(ramp(255), ramp(4095)), 16);
  EXPECT_EQ(bit_depth_ratio(ramp(65535), ramp(4095)), 1.0 / 16);
  EXPECT_EQ(bit_depth_ratio(ramp(1023), ramp(4095)), 4);
  // With another gain, too.
  EXPECT_EQ(bit_depth_ratio(ramp(200), ramp(4095)), 16);
  EXPECT_EQ(bit_depth_ratio(ramp(255), ramp(3300)), 16);
}

TEST(GreyScale, GainAloneIsNoBitDepth) {
  EXPECT_EQ(bit_depth_ratio(ramp(4095), ramp(4095)), 1);
  EXPECT_EQ(bit_depth_ratio(ramp(1600), ramp(4095)), 1);
  EXPECT_EQ(bit_depth_ratio(ramp(4095), ramp(1600)), 1);
  EXPECT_EQ(bit_depth_ratio(ramp(0), ramp(4095)), 1);
  EXPECT_EQ(bit_depth_ratio(ramp(4095), ramp(0)), 1);
}

}  // namespace crease
