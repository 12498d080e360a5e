#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Images/IntensityRange.h"
#include "Images/Moments.h"
#include "Testing/Images/TestImages.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using testing::image_of;
using testing::noise_image;
using testing::plain_raster;
using ::testing::ThrowsMessage;
using testing::turned_raster;

Mask<2> stripes(const Raster<2>& raster) {
  Mask<2> mask(raster);
  for (std::size_t p = 0; p < mask.values().size(); ++p) mask.values()[p] = p % 3 == 0;
  return mask;
}

// Negative values, ties and enough pixels for several blocks; the truth by sorting.
TEST(IntensityRange, PercentilesAreThoseOfTheSortedPixels) {
  auto image = noise_image(plain_raster<2>({900, 700}));
  for (float& v : image.values()) v = v < 0.1f ? -0.25f : 40 * v - 20;
  const auto mask = stripes(image.raster());
  std::vector<float> sorted;
  for (std::size_t p = 0; p < image.values().size(); ++p) {
    if (mask.values()[p] != 0) sorted.push_back(image.values()[p]);
  }
  std::ranges::sort(sorted);
  const auto rank = [&](double percent) {
    return sorted[static_cast<std::size_t>(
        std::lround(percent / 100 * static_cast<double>(sorted.size() - 1)))];
  };
  for (double percent : {0.0, 1.0, 5.0, 37.5, 50.0}) {
    const auto range = intensity_percentiles(image, &mask, percent, 100 - percent);
    EXPECT_EQ(range.lower, rank(percent));
    EXPECT_EQ(range.upper, rank(100 - percent));
  }
  EXPECT_EQ(intensity_range(image, &mask).lower, sorted.front());
  EXPECT_EQ(intensity_range(image, &mask).upper, sorted.back());
}

TEST(IntensityRange, TellsConstantImages) {
  const Image<float, 2> image(plain_raster<2>({9, 9}), -3.0f);
  EXPECT_TRUE(intensity_range(image).constant());
  EXPECT_TRUE(intensity_percentiles(image).constant());
  EXPECT_FALSE(intensity_range(noise_image(image.raster())).constant());
}

TEST(IntensityRange, RefusesEmptyAndForeignMasks) {
  const auto image = noise_image(plain_raster<2>({9, 9}));
  const Mask<2> empty(image.raster()), foreign(plain_raster<2>({9, 8}), 1);
  EXPECT_THAT([&] { intensity_percentiles(image, &empty); },
              ThrowsMessage<InvalidInput>(HasSubstr("the mask is empty")));
  EXPECT_THAT([&] { intensity_range(image, &foreign); },
              ThrowsMessage<InvalidInput>(HasSubstr("another size")));
  EXPECT_THROW(intensity_percentiles(image, nullptr, 50, 40), InvalidInput);
  EXPECT_THROW(moments(image, &empty), InvalidInput);
}

// A Gaussian on a raised background: its centre and width, whatever the background is.
template <int Dim>
void expect_moments_of_a_gaussian(double background) {
  std::array<int, Dim> size;
  size.fill(Dim == 2 ? 90 : 45);
  auto raster = turned_raster<Dim>(size);
  raster.spacing.setConstant(Dim == 2 ? 0.8 : 1.6);
  Vector<Dim> middle = Vector<Dim>::Constant(std::floor(0.5 * size[0]) + 1.25);
  const Point<Dim> centre = raster.point(middle);
  const double sigma = 5;
  const auto image = image_of(raster, [&](const Vector<Dim>& index) {
    return background +
           100 * std::exp(-0.5 * (raster.point(index) - centre).squaredNorm() / (sigma * sigma));
  });
  const auto found = moments(image);
  EXPECT_LT((found.centre - centre).norm(), 1e-3);
  EXPECT_LT((found.covariance - sigma * sigma * Matrix<Dim>::Identity()).norm(), 0.05);
  const double mass = 100 * std::pow(2 * 3.14159265358979 * sigma * sigma, Dim / 2.0);
  EXPECT_NEAR(found.mass, mass, 1e-3 * mass);
}

TEST(Moments, FindCentreAndWidthOfAGaussian) {
  for (double background : {0.0, -1000.0, 50.0}) {
    expect_moments_of_a_gaussian<2>(background);
    expect_moments_of_a_gaussian<3>(background);
  }
}

TEST(Moments, CountOnlyTheMask) {
  const auto raster = turned_raster<2>({20, 10});
  auto image = noise_image(raster);
  Mask<2> mask(raster);
  mask(4, 3) = mask(8, 3) = 1;
  image(4, 3) = 1;
  image(8, 3) = 5;  // all mass is here: the lower of the two counts nothing
  EXPECT_LT((moments(image, &mask).centre - raster.point(Vector<2>(8, 3))).norm(), 1e-9);
  image(4, 3) = 5;  // constant: the middle of the mask, and no mass
  EXPECT_LT((moments(image, &mask).centre - raster.point(Vector<2>(6, 3))).norm(), 1e-9);
  EXPECT_EQ(moments(image, &mask).mass, 0);
}

TEST(Moments, GeometricCentreIsTheMiddleOfAllPixels) {
  const auto raster = turned_raster<3>({5, 4, 3});
  EXPECT_LT((geometric_centre(raster) - raster.point(Vector<3>(2, 1.5, 1))).norm(), 1e-12);
}

TEST(Moments, SameBitsOnAnyNumberOfThreads) {
  const auto image = noise_image(turned_raster<2>({301, 207}));
  std::vector<Point<2>> centres;
  for (int threads : {1, 2, 8}) {
    set_num_threads(threads);
    centres.push_back(moments(image).centre);
  }
  set_num_threads(0);
  EXPECT_EQ(centres[0], centres[1]);
  EXPECT_EQ(centres[0], centres[2]);
}

}  // namespace
}  // namespace crease
