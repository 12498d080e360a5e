#include "Transforms/Domains/RegionOfInterest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "Core/Error.h"
#include "Testing/Transforms/Domains/SampleDomains.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const Polyline kSquare = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
const Polyline kInner = {{2, 2}, {4, 2}, {4, 4}, {2, 4}};

std::string write_file(const std::string& name, const std::string& text) {
  const auto path = std::filesystem::temp_directory_path() / ("crease_roi_" + name);
  std::ofstream(path) << text;
  return path.string();
}

}  // namespace

TEST(RegionOfInterest, NestedRingsAreHolesAndIslands) {
  const Polyline island = {{2.5, 2.5}, {3.5, 2.5}, {3.5, 3.5}, {2.5, 3.5}};
  const RegionOfInterest region({kInner, kSquare, island});
  EXPECT_NEAR(region.area(), 100 - 4 + 1, 1e-12);
  EXPECT_TRUE(region.contains({1, 1}));
  EXPECT_FALSE(region.contains({2.2, 2.2}));
  EXPECT_TRUE(region.contains({3, 3}));
  EXPECT_FALSE(region.contains({11, 3}));
}

TEST(RegionOfInterest, NamesTheErrorWithItsPoint) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(
      [] {
        RegionOfInterest({{{0, 0}, {2, 2}, {2, 0}, {0, 2}}});
      },
      ThrowsMessage<InvalidInput>(AllOf(HasSubstr("crosses itself"), HasSubstr("points 1 and 3"))));
  EXPECT_THAT(
      [] {
        RegionOfInterest({{{0, 0}, {2, 2}}});
      },
      ThrowsMessage<InvalidInput>(HasSubstr("has 2 point(s)")));
  EXPECT_THAT(
      [] {
        RegionOfInterest({{{0, 0}, {1, 1}, {2, 2}}});
      },
      ThrowsMessage<InvalidInput>(HasSubstr("no area")));
  EXPECT_THAT(
      [&] {
        RegionOfInterest({{{0, 0}, {1, nan}, {2, 2}}});
      },
      ThrowsMessage<InvalidInput>(AllOf(HasSubstr("point 2"), HasSubstr("not finite"))));
  EXPECT_THAT(
      [] {
        RegionOfInterest({{{0, 0}, {1, 0}, {1, 0}, {2, 2}}});
      },
      ThrowsMessage<InvalidInput>(HasSubstr("points 2 and 3 coincide")));
  EXPECT_THAT(
      [] {
        RegionOfInterest({kSquare, {{5, 5}, {15, 5}, {15, 8}}});
      },
      ThrowsMessage<InvalidInput>(HasSubstr("rings 1 and 2 meet")));
  EXPECT_THAT([] { RegionOfInterest({}); }, ThrowsMessage<InvalidInput>(HasSubstr("no polygon")));
}

TEST(RegionOfInterest, RectangleOfATurnedRasterCoversItsPixels) {
  Raster<2> raster;
  raster.size = {20, 10};
  raster.spacing = {0.5, 2};
  raster.origin = {3, -4};
  raster.direction << 0.6, -0.8, 0.8, 0.6;
  const auto region = rectangle_of(raster);
  EXPECT_NEAR(region.area(), 20 * 10 * raster.sample_volume(), 1e-11);
  EXPECT_TRUE(region.contains(raster.point({-0.49, 9.49})));
  EXPECT_FALSE(region.contains(raster.point({-0.51, 5})));
}

TEST(RegionOfInterest, MirroredRasterGivesACounterClockwiseRing) {
  Raster<2> raster;
  raster.size = {4, 4};
  raster.direction << 1, 0, 0, -1;
  EXPECT_NEAR(rectangle_of(raster).area(), 16, 1e-12);
}

TEST(RegionOfInterest, MaskGivesContoursAndHolesWithinAPixel) {
  const auto raster = testing::square_raster(100);
  std::vector<std::uint8_t> mask(100 * 100, 0);
  const Point<2> centre(48.3, 51.7);
  int count = 0;
  for (int j = 0; j < 100; ++j) {
    for (int i = 0; i < 100; ++i) {
      const double r = (Point<2>(i, j) - centre).norm();
      mask[j * 100 + i] = r < 40 && r > 15;
      count += r < 40 && r > 15;
    }
  }
  const auto region = region_of_mask(raster, mask);
  ASSERT_EQ(region.rings().size(), 2U);
  EXPECT_NEAR(region.area(), count, 0.01 * count);
  for (const auto& ring : region.rings()) {
    for (const auto& p : ring) {
      const double r = (p - centre).norm();
      EXPECT_LT(std::min(std::abs(r - 40), std::abs(r - 15)), 1);
    }
    EXPECT_LT(ring.size(), 80U);  // simplified, from about 500
  }
}

TEST(RegionOfInterest, FullMaskIsTheRectangleAndAMaskAtTheBorderReachesIt) {
  const auto raster = testing::square_raster(20);
  std::vector<std::uint8_t> mask(400, 1);
  EXPECT_NEAR(region_of_mask(raster, mask).area(), 400, 1e-12);
  for (int k = 0; k < 200; ++k) mask[k] = 0;
  const auto box = region_of_mask(raster, mask).bounds();
  EXPECT_NEAR(box.lower.x(), -0.5, 1e-12);
  EXPECT_NEAR(box.lower.y(), 9.5, 1e-12);
  EXPECT_NEAR(box.upper.y(), 19.5, 1e-12);
}

TEST(RegionOfInterest, EmptyMaskIsRefused) {
  const auto raster = testing::square_raster(8);
  EXPECT_THAT([&] { region_of_mask(raster, std::vector<std::uint8_t>(64, 0)); },
              ThrowsMessage<InvalidInput>(HasSubstr("mask is empty")));
  EXPECT_THAT([&] { region_of_mask(raster, std::vector<std::uint8_t>(60, 1)); },
              ThrowsMessage<InvalidInput>(HasSubstr("60 values")));
}

TEST(RegionOfInterest, ReadsRingsFromCsv) {
  const auto path =
      write_file("ok.csv", "ring,x,y\n1,0,0\n1,10,0\n1,10,10\n1,0,10\n2,2,2\n2,4,2\n2,4,4\n");
  EXPECT_NEAR(read_region_of_interest(path).area(), 98, 1e-12);
}

TEST(RegionOfInterest, CsvErrorsNameFileRowAndColumn) {
  const auto bad = write_file("bad.csv", "ring,x,y\n1,0,0\n1,ten,0\n1,10,10\n");
  EXPECT_THAT([&] { read_region_of_interest(bad); },
              ThrowsMessage<InvalidInput>(
                  AllOf(HasSubstr("bad.csv, row 3"), HasSubstr("column 'x'"), HasSubstr("ten"))));
  const auto crossed = write_file("crossed.csv", "ring,x,y\n1,0,0\n1,2,2\n1,2,0\n1,0,2\n");
  EXPECT_THAT(
      [&] { read_region_of_interest(crossed); },
      ThrowsMessage<InvalidInput>(AllOf(HasSubstr("crossed.csv"), HasSubstr("points 1 and 3"))));
  EXPECT_THROW(read_region_of_interest("/no/such/file.csv"), FileError);
}

TEST(RegionOfInterest, ShareOutsideTheImage) {
  const auto raster = testing::square_raster(10);  // [-0.5, 9.5]^2
  EXPECT_NEAR(share_outside(testing::rectangle(0, 0, 9, 9), raster), 0, 1e-12);
  EXPECT_NEAR(share_outside(testing::rectangle(4.5, 0, 14.5, 9), raster), 0.5, 1e-12);
  EXPECT_NEAR(share_outside(testing::rectangle(20, 0, 30, 9), raster), 1, 1e-12);
  const RegionOfInterest ell({{{0, 0}, {20, 0}, {20, 2}, {2, 2}, {2, 20}, {0, 20}}});
  EXPECT_NEAR(share_outside(ell, raster), 1 - (9.5 * 2 + 7.5 * 2) / 76, 1e-12);
}

}  // namespace crease
