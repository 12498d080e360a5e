#include "Images/Interpolator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Images/CubicBSplineInterpolator.h"
#include "Images/LinearInterpolator.h"
#include "Images/MakeInterpolator.h"
#include "Images/Smoothing.h"
#include "Testing/Images/TestImages.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using testing::image_of;
using testing::noise_image;
using testing::plain_raster;
using ::testing::ThrowsMessage;
using testing::turned_raster;

template <int Dim>
constexpr std::array<int, Dim> test_size() {
  if constexpr (Dim == 2) return {37, 29};
  if constexpr (Dim == 3) return {21, 17, 13};
}

/// Rows of displacements with their buffers, no longer than they must be.
template <int Dim>
struct Row {
  MappedRow<Dim> mapped;
  std::array<std::vector<float>, Dim> displacement, gradient;
  std::vector<float> value, inside;

  void evaluate(const Interpolator<Dim>& interpolator) {
    const auto size = static_cast<std::size_t>(mapped.end);
    value.assign(size, -1);
    inside.assign(size, -1);
    std::array<float*, Dim> gradients;
    for (int a = 0; a < Dim; ++a) {
      gradient[a].assign(size, -1);
      gradients[a] = gradient[a].data();
      if (!displacement[a].empty()) mapped.displacement[a] = displacement[a].data();
    }
    interpolator.evaluate_row(mapped, value.data(), gradients, inside.data());
  }
  Point<Dim> point(int i) const {
    Point<Dim> p = mapped.start + i * mapped.step;
    for (int a = 0; a < Dim; ++a) {
      if (!displacement[a].empty()) {
        p[a] += static_cast<double>(displacement[a][static_cast<std::size_t>(i)]);
      }
    }
    return p;
  }
};

/// Row r of the raster, displaced by smooth waves of the given size.
template <int Dim>
Row<Dim> waving_row(const Raster<Dim>& raster, std::int64_t r, double amplitude_mm) {
  Row<Dim> row;
  row.mapped.row = r;
  row.mapped.begin = 3;
  row.mapped.end = raster.size[0];
  row.mapped.start = raster.row_start(r);
  row.mapped.step = raster.index_to_point().col(0);
  for (int a = 0; a < Dim; ++a) {
    for (int i = 0; i < raster.size[0]; ++i) {
      row.displacement[a].push_back(static_cast<float>(
          amplitude_mm * std::sin(0.031 * i + 0.7 * a + 0.13 * static_cast<double>(r))));
    }
  }
  return row;
}

/// Largest differences between rows and single points over all rows.
/// @param avoid  points whose index is this close to a whole number do not count for the gradient.
template <int Dim>
void compare_rows_with_points(const Interpolator<Dim>& interpolator, const Raster<Dim>& raster,
                              double amplitude_mm, double avoid, double tolerance) {
  std::int64_t inside = 0, outside = 0;
  for (std::int64_t r = 0; r < raster.num_rows(); r += 1 + raster.num_rows() / 100) {
    Row<Dim> row = waving_row(raster, r, amplitude_mm);
    row.evaluate(interpolator);
    for (int i = row.mapped.begin; i < row.mapped.end; ++i) {
      const auto expected = interpolator.evaluate(row.point(i));
      const auto at = static_cast<std::size_t>(i);
      ASSERT_NEAR(row.value[at], expected.value, tolerance) << "row " << r << ", sample " << i;
      ASSERT_EQ(row.inside[at] != 0, expected.inside) << "row " << r << ", sample " << i;
      (expected.inside ? inside : outside) += 1;
      const Vector<Dim> index = interpolator.raster().index(row.point(i));
      if (avoid > 0 && ((index.array() - index.array().round()).abs() < avoid).any()) continue;
      for (int a = 0; a < Dim; ++a) {
        ASSERT_NEAR(row.gradient[a][at], expected.gradient[a], tolerance)
            << "row " << r << ", sample " << i << ", component " << a;
      }
    }
  }
  EXPECT_GT(inside, 100);
  EXPECT_GT(outside, 10);  // the waves reach beyond the border
}

template <typename T>
class EveryInterpolator : public ::testing::Test {};
template <template <int> class Type, int D>
struct Case {
  template <int Dim>
  using Interpolator = Type<Dim>;
  static constexpr int kDim = D;
  static constexpr bool kCubic = std::is_same_v<Type<D>, CubicBSplineInterpolator<D>>;
};
using Cases =
    ::testing::Types<Case<LinearInterpolator, 2>, Case<LinearInterpolator, 3>,
                     Case<CubicBSplineInterpolator, 2>, Case<CubicBSplineInterpolator, 3>>;
TYPED_TEST_SUITE(EveryInterpolator, Cases);

TYPED_TEST(EveryInterpolator, PassesThroughThePixels) {
  constexpr int Dim = TypeParam::kDim;
  const auto image = noise_image(turned_raster<Dim>(test_size<Dim>()));
  const typename TypeParam::template Interpolator<Dim> interpolator(image);
  for (std::int64_t p = 0; p < image.raster().num_samples(); ++p) {
    Vector<Dim> index;
    for (int a = 0; a < Dim; ++a) index[a] = image.index(p)[a];
    const auto sample = interpolator.evaluate(image.raster().point(index));
    ASSERT_NEAR(sample.value, image.values()[static_cast<std::size_t>(p)], 1e-6);
    ASSERT_TRUE(sample.inside);
  }
}

TYPED_TEST(EveryInterpolator, GradientMatchesCentralDifferences) {
  constexpr int Dim = TypeParam::kDim;
  const auto image = noise_image(turned_raster<Dim>(test_size<Dim>()));
  const typename TypeParam::template Interpolator<Dim> interpolator(image);
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(0.01, 0.99);
  const double step = 1e-5;  // mm
  for (int n = 0; n < 500; ++n) {
    Vector<Dim> index;  // off the grid lines, where linear interpolation has no gradient
    for (int a = 0; a < Dim; ++a) {
      index[a] = std::floor(uniform(generator) * (image.size()[a] - 1)) + uniform(generator);
    }
    const Point<Dim> x = image.raster().point(index);
    const auto sample = interpolator.evaluate(x);
    for (int a = 0; a < Dim; ++a) {
      const Vector<Dim> h = step * Vector<Dim>::Unit(a);
      const double difference =
          (interpolator.evaluate(x + h).value - interpolator.evaluate(x - h).value) / (2 * step);
      ASSERT_NEAR(sample.gradient[a], difference, 2e-9 / step * 1e-2 + 1e-9);
    }
  }
}

// Single precision rounds the position to some 5e-7 pixels, which white noise with its steep gradients
// would show: these images are as smooth as a scanner's.
TYPED_TEST(EveryInterpolator, RowsAgreeWithPoints) {
  constexpr int Dim = TypeParam::kDim;
  const auto image = smooth_121(noise_image(turned_raster<Dim>(test_size<Dim>())));
  const typename TypeParam::template Interpolator<Dim> interpolator(image);
  compare_rows_with_points<Dim>(interpolator, image.raster(), 6.0, TypeParam::kCubic ? 0 : 1e-4,
                                2e-6);
}

TYPED_TEST(EveryInterpolator, RowsOfAnotherRasterAgreeWithPoints) {
  constexpr int Dim = TypeParam::kDim;
  const auto image = smooth_121(noise_image(turned_raster<Dim>(test_size<Dim>())));
  const typename TypeParam::template Interpolator<Dim> interpolator(image);
  Raster<Dim> other = plain_raster<Dim>(test_size<Dim>());
  other.origin = image.raster().origin - Vector<Dim>::Constant(3);
  other.spacing *= 1.1;
  compare_rows_with_points<Dim>(interpolator, other, 2.0, TypeParam::kCubic ? 0 : 1e-4, 2e-6);
}

// A float resolves only 1.2e-4 pixels at column 2000: whole pixels must be kept apart.
TYPED_TEST(EveryInterpolator, WideImagesLoseNothing) {
  constexpr int Dim = TypeParam::kDim;
  std::array<int, Dim> size;
  size.fill(9);
  size[0] = 2300;
  const auto image = smooth_121(noise_image(plain_raster<Dim>(size)));
  const typename TypeParam::template Interpolator<Dim> interpolator(image);
  compare_rows_with_points<Dim>(interpolator, image.raster(), 4.3, TypeParam::kCubic ? 0 : 1e-4,
                                2e-6);
}

// Beyond the border the value is that of the nearest border point; only there is the gradient zero.
TYPED_TEST(EveryInterpolator, ClampsBeyondTheOuterCentres) {
  constexpr int Dim = TypeParam::kDim;
  const auto image = noise_image(plain_raster<Dim>(test_size<Dim>()));
  const typename TypeParam::template Interpolator<Dim> interpolator(image);
  Point<Dim> border = Point<Dim>::Constant(4.3);
  border[0] = 0;
  const auto at_border = interpolator.evaluate(border);
  for (double distance : {0.2, 0.499, 0.501, 5.0, 1e6}) {
    Point<Dim> x = border;
    x[0] -= distance;
    const auto sample = interpolator.evaluate(x);
    EXPECT_DOUBLE_EQ(sample.value, at_border.value);
    EXPECT_EQ(sample.inside, distance < 0.5);
    EXPECT_EQ(sample.gradient[0], 0);
    if (sample.inside) {
      EXPECT_DOUBLE_EQ(sample.gradient[1], at_border.gradient[1]);
    } else {
      EXPECT_EQ(sample.gradient.norm(), 0);
    }
    x[0] = image.size()[0] - 1 + distance;
    border[0] = image.size()[0] - 1;
    EXPECT_DOUBLE_EQ(interpolator.evaluate(x).value, interpolator.evaluate(border).value);
    EXPECT_EQ(interpolator.evaluate(x).inside, distance < 0.5);
    EXPECT_NEAR(interpolator.evaluate(x).gradient[0], 0, 1e-12);
    border[0] = 0;
  }
}

TYPED_TEST(EveryInterpolator, RowsFarOutsideAgreeWithPoints) {
  constexpr int Dim = TypeParam::kDim;
  const auto image = noise_image(turned_raster<Dim>(test_size<Dim>()));
  const typename TypeParam::template Interpolator<Dim> interpolator(image);
  for (double shift : {-1e12, -2500.0, 2500.0, 3e9}) {
    Row<Dim> row = waving_row(image.raster(), 2, 1.0);
    row.mapped.start += Vector<Dim>::Constant(shift);
    row.evaluate(interpolator);
    for (int i = row.mapped.begin; i < row.mapped.end; ++i) {
      const auto at = static_cast<std::size_t>(i);
      ASSERT_NEAR(row.value[at], interpolator.evaluate(row.point(i)).value, 2e-6);
      ASSERT_EQ(row.inside[at], 0);
      for (int a = 0; a < Dim; ++a) ASSERT_EQ(row.gradient[a][at], 0);
    }
  }
}

// The displacement may bring points back into the image from far away.
TYPED_TEST(EveryInterpolator, LargeDisplacementsReachTheImage) {
  constexpr int Dim = TypeParam::kDim;
  const auto image = noise_image(plain_raster<Dim>(test_size<Dim>()));
  const typename TypeParam::template Interpolator<Dim> interpolator(image);
  Row<Dim> row = waving_row(image.raster(), 4, 1.0);
  row.mapped.start -= Vector<Dim>::Constant(256);
  for (auto& component : row.displacement) {
    for (float& u : component) u += 256;
  }
  row.evaluate(interpolator);
  for (int i = row.mapped.begin; i < row.mapped.end; ++i) {  // a float near 256 resolves 1.5e-5 mm
    ASSERT_NEAR(row.value[static_cast<std::size_t>(i)], interpolator.evaluate(row.point(i)).value,
                6e-5);
  }
}

TYPED_TEST(EveryInterpolator, WritesNothingBeyondTheRow) {
  constexpr int Dim = TypeParam::kDim;
  const auto image = noise_image(plain_raster<Dim>(test_size<Dim>()));
  const typename TypeParam::template Interpolator<Dim> interpolator(image);
  for (int begin = 0; begin < 10; ++begin) {
    for (int end = begin; end < begin + 20; ++end) {
      MappedRow<Dim> row;
      row.begin = begin;
      row.end = end;
      row.step = Vector<Dim>::Unit(0);
      std::vector<float> value(40, 7), inside(40, 7), dx(40, 7);
      std::array<float*, Dim> gradient{};
      gradient[0] = dx.data();
      interpolator.evaluate_row(row, value.data(), gradient, inside.data());
      for (int i = 0; i < 40; ++i) {
        const bool written = i >= begin && i < end;
        ASSERT_EQ(inside[static_cast<std::size_t>(i)] == 7, !written);
        ASSERT_EQ(value[static_cast<std::size_t>(i)] == 7, !written);
        ASSERT_EQ(dx[static_cast<std::size_t>(i)] == 7, !written);
      }
    }
  }
}

TYPED_TEST(EveryInterpolator, PointsThatAreNotFiniteHaveNoValue) {
  constexpr int Dim = TypeParam::kDim;
  const auto image = noise_image(plain_raster<Dim>(test_size<Dim>()));
  const typename TypeParam::template Interpolator<Dim> interpolator(image);
  constexpr float kBad[] = {std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity()};
  for (float bad : kBad) {
    Row<Dim> row = waving_row(image.raster(), 4, 1.0);
    row.displacement[1][9] = bad;
    row.evaluate(interpolator);
    EXPECT_TRUE(std::isnan(row.value[9]));
    EXPECT_EQ(row.inside[9], 0);
    EXPECT_FALSE(std::isnan(row.value[8]));
    const auto sample = interpolator.evaluate(row.point(9));
    EXPECT_TRUE(std::isnan(sample.value));
    EXPECT_FALSE(sample.inside);
  }
}

TYPED_TEST(EveryInterpolator, AxesOfOneOrTwoPixelsWork) {
  constexpr int Dim = TypeParam::kDim;
  for (int short_size : {1, 2, 3}) {
    for (int axis = 0; axis < Dim; ++axis) {
      std::array<int, Dim> size;
      size.fill(12);
      size[axis] = short_size;
      const auto image = noise_image(plain_raster<Dim>(size));
      const typename TypeParam::template Interpolator<Dim> interpolator(image);
      const auto raster = plain_raster<Dim>(test_size<Dim>());
      for (std::int64_t r = 0; r < 12; ++r) {
        Row<Dim> row = waving_row(raster, r, 0.8);
        row.evaluate(interpolator);
        for (int i = row.mapped.begin; i < 15; ++i) {
          const auto expected = interpolator.evaluate(row.point(i));
          const auto at = static_cast<std::size_t>(i);
          ASSERT_NEAR(row.value[at], expected.value, 2e-6);
          if (short_size == 1) {
            ASSERT_EQ(row.gradient[axis][at], 0);
          }
        }
      }
      for (std::int64_t p = 0; p < image.raster().num_samples(); ++p) {
        Vector<Dim> index;
        for (int a = 0; a < Dim; ++a) index[a] = image.index(p)[a];
        ASSERT_NEAR(interpolator.evaluate(index).value, image.values()[static_cast<std::size_t>(p)],
                    1e-6);
      }
    }
  }
}

TYPED_TEST(EveryInterpolator, CoefficientRangeBoundsTheValues) {
  constexpr int Dim = TypeParam::kDim;
  const auto image = noise_image(plain_raster<Dim>(test_size<Dim>()));
  const typename TypeParam::template Interpolator<Dim> interpolator(image);
  Mask<Dim> mask(image.raster());
  std::array<int, Dim> pixel;
  pixel.fill(6);
  mask[pixel] = 1;
  const auto all = interpolator.coefficient_range(), near = interpolator.coefficient_range(mask);
  EXPECT_LT(all.lower, near.lower);
  EXPECT_GT(all.upper, near.upper);
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(5.5, 6.5);
  for (int n = 0; n < 1000; ++n) {
    Point<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = uniform(generator);
    const double value = interpolator.evaluate(x).value;
    ASSERT_GE(value, near.lower);
    ASSERT_LE(value, near.upper);
  }
  EXPECT_THROW(interpolator.coefficient_range(Mask<Dim>(image.raster())), InvalidInput);
}

TYPED_TEST(EveryInterpolator, RefusesPixelsThatAreNotFinite) {
  constexpr int Dim = TypeParam::kDim;
  auto image = noise_image(plain_raster<Dim>(test_size<Dim>()));
  std::array<int, Dim> pixel;
  pixel.fill(2);
  pixel[0] = 7;
  image[pixel] = std::numeric_limits<float>::quiet_NaN();
  image.values().back() = -std::numeric_limits<float>::max();
  const std::string place = Dim == 2 ? "(7, 2)" : "(7, 2, 2)";
  EXPECT_THAT([&] { make_interpolator(image); },
              ThrowsMessage<InvalidInput>(
                  ::testing::AllOf(HasSubstr("2 pixels are not finite"), HasSubstr(place))));
}

TEST(CubicBSplineInterpolator, SameBitsOnAnyNumberOfThreads) {
  const auto image = noise_image(turned_raster<2>({317, 211}));
  std::vector<std::vector<float>> values;
  for (int threads : {1, 2, 8}) {
    set_num_threads(threads);
    const CubicBSplineInterpolator<2> interpolator(image);
    std::vector<float> all;
    for (std::int64_t r = 0; r < image.raster().num_rows(); ++r) {
      auto row = waving_row(image.raster(), r, 2.0);
      row.evaluate(interpolator);
      all.insert(all.end(), row.value.begin(), row.value.end());
      all.insert(all.end(), row.gradient[1].begin(), row.gradient[1].end());
    }
    values.push_back(all);
  }
  set_num_threads(0);
  EXPECT_EQ(values[0], values[1]);
  EXPECT_EQ(values[0], values[2]);
}

}  // namespace
}  // namespace crease
