#include "Images/Pyramid.h"

#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Images/Smoothing.h"
#include "Testing/Images/TestImages.h"

namespace crease {
namespace {

using testing::image_of;
using testing::noise_image;
using testing::plain_raster;
using testing::turned_raster;

// The kernel is symmetric about the coarse pixel's centre, so a linear function of position stays one: its
// coarse pixels show that the coarse raster lies where it should.
template <int Dim>
void expect_linear_functions_stay(const std::array<int, Dim>& size) {
  const auto raster = turned_raster<Dim>(size);
  const auto f = [](const Point<Dim>& x) { return 3 + Vector<Dim>::LinSpaced(0.1, 0.3).dot(x); };
  const auto image =
      image_of(raster, [&](const Vector<Dim>& index) { return f(raster.point(index)); });
  ShrinkFactors<Dim> factors;
  factors.fill(4);
  factors[0] = 2;
  const auto coarse = shrink(image, factors);
  for (std::int64_t p = 0; p < coarse.raster().num_samples(); ++p) {
    const auto at = coarse.index(p);
    Vector<Dim> index;
    bool border = false;
    for (int a = 0; a < Dim; ++a) {
      index[a] = at[a];
      EXPECT_EQ(coarse.size()[a], (size[a] + factors[a] - 1) / factors[a]);
      border = border || at[a] == 0 || at[a] >= coarse.size()[a] - 2;
    }
    if (border) continue;  // there, outer pixels are repeated
    ASSERT_NEAR(coarse[at], f(coarse.raster().point(index)), 2e-5);
  }
}

TEST(Pyramid, CoarsePixelsLieWhereTheyShould) {
  expect_linear_functions_stay<2>({40, 52});
  expect_linear_functions_stay<2>({41, 53});
  expect_linear_functions_stay<3>({21, 26, 33});
}

TEST(Pyramid, UsesTheKernel1331) {
  Image<float, 2> image(plain_raster<2>({8, 8}));
  image(3, 4) = 64;
  const auto coarse = shrink(image, ShrinkFactors<2>{2, 2});
  EXPECT_EQ(coarse(1, 2), 9);  // 3/8 * 3/8
  EXPECT_EQ(coarse(2, 2), 3);
  EXPECT_EQ(coarse(1, 1), 3);
  EXPECT_EQ(coarse(2, 1), 1);
  EXPECT_EQ(coarse(0, 2), 0);
}

TEST(Pyramid, KeepsConstantImages) {
  for (int width : {1, 2, 3, 16, 17}) {
    const Image<float, 2> image(plain_raster<2>({width, 19}), 5.0f);
    const auto coarse = shrink(image, ShrinkFactors<2>{2, 4});
    for (float v : coarse.values()) EXPECT_FLOAT_EQ(v, 5);
  }
}

TEST(Pyramid, HalvesOnlyAxesThatAreFineAndLong) {
  Raster<3> raster = plain_raster<3>({128, 128, 40});
  raster.spacing = {0.5, 0.5, 2.0};
  EXPECT_EQ(shrink_factors(raster, 0), (ShrinkFactors<3>{1, 1, 1}));
  EXPECT_EQ(shrink_factors(raster, 1), (ShrinkFactors<3>{2, 2, 1}));
  EXPECT_EQ(shrink_factors(raster, 2), (ShrinkFactors<3>{4, 4, 1}));
  EXPECT_EQ(shrink_factors(raster, 3), (ShrinkFactors<3>{8, 8, 2}));  // now all are alike
  EXPECT_EQ(shrink_factors(plain_raster<2>({256, 9}), 2), (ShrinkFactors<2>{4, 1}));
  EXPECT_EQ(num_pyramid_levels(plain_raster<2>({512, 300})), 4);
  EXPECT_EQ(num_pyramid_levels(plain_raster<2>({40, 30})), 1);
}

TEST(Pyramid, LevelsFollowFromEachOther) {
  const auto image = noise_image(turned_raster<2>({100, 75}));
  const auto pyramid = make_pyramid(image, 3);
  ASSERT_EQ(pyramid.size(), 3u);
  EXPECT_EQ(pyramid[0].values(), image.values());
  for (int level : {1, 2}) {
    const auto factors = shrink_factors(image.raster(), level);
    EXPECT_EQ(pyramid[level].raster().size, shrink(image.raster(), factors).size);
    EXPECT_LT((pyramid[level].raster().origin - shrink(image.raster(), factors).origin).norm(),
              1e-12);
  }
  EXPECT_THROW(make_pyramid(image, 0), InvalidInput);
  EXPECT_THROW(shrink(image, ShrinkFactors<2>{3, 1}), InvalidInput);
}

TEST(Pyramid, MasksByMoreThanHalfTheArea) {
  Mask<2> mask(plain_raster<2>({5, 4}));
  mask(0, 0) = mask(1, 0) = 1;               // half of the first coarse pixel: not enough
  mask(2, 0) = mask(3, 0) = mask(2, 1) = 1;  // three quarters
  mask(4, 2) = mask(4, 3) = 1;               // all that there is at the odd border
  const auto coarse = shrink_mask(mask, ShrinkFactors<2>{2, 2});
  EXPECT_EQ(coarse.values(), (std::vector<std::uint8_t>{0, 1, 0, 0, 0, 1}));
}

TEST(Pyramid, LabelsByMajority) {
  LabelImage<2> labels(plain_raster<2>({4, 2}), {7, 7, 3, 0, 7, 2, 0, 3});
  const auto coarse = shrink_labels(labels, ShrinkFactors<2>{2, 2});
  EXPECT_EQ(coarse.values(), (std::vector<std::int32_t>{7, 0}));
}

TEST(Smoothing, Kernel121KeepsLinearFunctionsAndWeighsTheCentre) {
  Image<float, 3> image(plain_raster<3>({7, 7, 7}));
  image(3, 3, 3) = 64;
  const auto smooth = smooth_121(image);
  EXPECT_EQ(smooth(3, 3, 3), 8);
  EXPECT_EQ(smooth(2, 3, 3), 4);
  EXPECT_EQ(smooth(2, 2, 2), 1);
  EXPECT_EQ(smooth(1, 3, 3), 0);
}

// The second moment of the response to a point is sigma^2 along every axis, in mm^2.
TEST(Smoothing, GaussianHasItsWidthInMillimetres) {
  Raster<2> raster = plain_raster<2>({61, 61});
  raster.spacing = {0.5, 1.0};
  Image<float, 2> image(raster);
  image(30, 30) = 1;
  const double sigma = 2;
  const auto smooth = gaussian_smooth(image, sigma);
  double mass = 0, xx = 0, yy = 0;
  for (int j = 0; j < 61; ++j) {
    for (int i = 0; i < 61; ++i) {
      const double v = smooth(i, j);
      mass += v;
      xx += v * (i - 30) * (i - 30) * 0.25;
      yy += v * (j - 30) * (j - 30);
    }
  }
  EXPECT_NEAR(mass, 1, 1e-5);
  EXPECT_NEAR(xx, sigma * sigma, 0.005);  // cut off at four sigma
  EXPECT_NEAR(yy, sigma * sigma, 0.005);
  EXPECT_EQ(gaussian_smooth(image, 0).values(), image.values());
  EXPECT_THROW(gaussian_smooth(image, -1), InvalidInput);
  EXPECT_THROW(gaussian_smooth(image, std::nan("")), InvalidInput);
}

TEST(Pyramid, SameBitsOnAnyNumberOfThreads) {
  const auto image = noise_image(plain_raster<3>({67, 45, 31}));
  std::vector<std::vector<float>> results;
  for (int threads : {1, 2, 8}) {
    set_num_threads(threads);
    auto values = make_pyramid(image, 3)[2].values();
    const auto smooth = gaussian_smooth(image, 1.3);
    values.insert(values.end(), smooth.values().begin(), smooth.values().end());
    results.push_back(values);
  }
  set_num_threads(0);
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

}  // namespace
}  // namespace crease
