#include "Core/Raster.h"

#include <gtest/gtest.h>

#include <cmath>

namespace crease {
namespace {
Raster<3> turned_raster() {
  Raster<3> raster;
  raster.size = {7, 5, 3};
  raster.origin = {10, -4, 2};
  raster.spacing = {0.5, 2, 3};
  const double c = std::cos(0.3), s = std::sin(0.3);
  raster.direction << c, -s, 0, s, c, 0, 0, 0, 1;
  return raster;
}
}  // namespace

TEST(Raster, IndexAndPointAreInverse) {
  const auto raster = turned_raster();
  const Vector<3> index(3.25, 1.5, 0.75);
  EXPECT_LT((raster.index(raster.point(index)) - index).norm(), 1e-13);
}

TEST(Raster, RowStartIsTheFirstSampleOfTheRow) {
  const auto raster = turned_raster();
  EXPECT_EQ(raster.num_rows(), 15);
  EXPECT_LT((raster.row_start(13) - raster.point({0, 3, 2})).norm(), 1e-13);
}

TEST(Raster, BoundsReachHalfAPixelBeyondTheCentres) {
  Raster<2> raster;
  raster.size = {4, 3};
  EXPECT_TRUE(raster.bounds().lower.isApprox(Point<2>(-0.5, -0.5)));
  EXPECT_TRUE(raster.bounds().upper.isApprox(Point<2>(3.5, 2.5)));
}

}  // namespace crease
