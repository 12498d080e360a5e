#include "Images/Resample.h"

#include <gtest/gtest.h>

#include <limits>

#include "Core/Parallel.h"
#include "Images/MakeInterpolator.h"
#include "Testing/Images/TestImages.h"

namespace crease {
namespace {

using testing::image_of;
using testing::noise_image;
using testing::plain_raster;
using testing::turned_raster;

template <int Dim>
void expect_whole_shifts_are_exact(InterpolationKind kind) {
  std::array<int, Dim> size;
  size.fill(14);
  size[0] = 23;
  const auto image = noise_image(turned_raster<Dim>(size));
  const auto moving = make_interpolator(image, kind);
  const Vector<Dim> shift = image.raster().index_to_point() * Vector<Dim>::Constant(3);
  const auto map = [&](const Point<Dim>& x) -> Point<Dim> { return x + shift; };
  const auto result = resample(*moving, image.raster(), map, -5.0f);

  DisplacementField<Dim> field(image.raster(), shift);
  const auto by_rows = resample(*moving, image.raster(), row_map(field), -5.0f);
  const auto nearest = resample_nearest(image, image.raster(), map, -5.0f);
  const auto nearest_by_rows = resample_nearest(image, image.raster(), row_map(field), -5.0f);
  for (std::int64_t p = 0; p < image.raster().num_samples(); ++p) {
    auto index = image.index(p);
    const auto at = static_cast<std::size_t>(p);
    bool inside = true;
    for (int a = 0; a < Dim; ++a) inside = inside && (index[a] += 3) < size[a];
    const float expected = inside ? image[index] : -5;
    ASSERT_NEAR(result.values()[at], expected, 2e-6);
    ASSERT_NEAR(by_rows.values()[at], expected, 5e-6);  // the shift is rounded to single precision
    ASSERT_EQ(nearest.values()[at], expected);
    ASSERT_EQ(nearest_by_rows.values()[at], expected);
  }
}

TEST(Resample, WholeShiftsAreExact) {
  expect_whole_shifts_are_exact<2>(InterpolationKind::kCubic);
  expect_whole_shifts_are_exact<3>(InterpolationKind::kCubic);
  expect_whole_shifts_are_exact<2>(InterpolationKind::kLinear);
  expect_whole_shifts_are_exact<3>(InterpolationKind::kLinear);
}

TEST(Resample, OntoAnotherRaster) {
  const auto f = [](const Point<2>& x) { return 0.3 + 0.01 * x[0] - 0.02 * x[1]; };
  const auto raster = turned_raster<2>({40, 30});
  const auto moving = make_interpolator(
      image_of(raster, [&](const Vector<2>& index) { return f(raster.point(index)); }),
      InterpolationKind::kLinear);
  Raster<2> other = plain_raster<2>({9, 7});
  other.origin = raster.point(Vector<2>(15, 10));
  other.spacing = {0.3, 0.7};
  const auto result = resample(*moving, other, [](const Point<2>& x) { return x; });
  for (int j = 0; j < 7; ++j) {
    for (int i = 0; i < 9; ++i) {
      EXPECT_NEAR(result(i, j), f(other.point(Vector<2>(i, j))), 1e-6);
    }
  }
}

TEST(Resample, LabelsStayLabels) {
  const LabelImage<2> labels(plain_raster<2>({3, 1}), {1, 20'000'001, 7});
  const auto result = resample_nearest(
      labels, plain_raster<2>({5, 1}), [](const Point<2>& x) -> Point<2> { return 0.5 * x; }, -1);
  EXPECT_EQ(result.values(), (std::vector<std::int32_t>{1, 20'000'001, 20'000'001, 7, 7}));
}

TEST(Resample, PointsThatAreNotFiniteAreOutside) {
  const auto image = noise_image(plain_raster<2>({9, 8}));
  const auto nan = [](const Point<2>&) -> Point<2> {
    return Point<2>::Constant(std::numeric_limits<double>::quiet_NaN());
  };
  const auto linear = resample(*make_interpolator(image), image.raster(), nan, 3.0f);
  const auto nearest = resample_nearest(image, image.raster(), nan, 3.0f);
  for (float v : linear.values()) EXPECT_EQ(v, 3);
  for (float v : nearest.values()) EXPECT_EQ(v, 3);
}

// A transform's domain may cover only part of a row.
TEST(Resample, RowsMayCoverPartOfTheRaster) {
  const auto image = noise_image(plain_raster<2>({20, 6}));
  const RowMap<2> map = [&](std::int64_t r, const std::array<float*, 2>&) {
    MappedRow<2> row;
    row.row = r;
    row.begin = 5;
    row.end = 12;
    row.start = image.raster().row_start(r);
    row.step = Vector<2>::Unit(0);
    return row;
  };
  const auto result = resample(*make_interpolator(image), image.raster(), map, -1.0f);
  for (int i = 0; i < 20; ++i) {
    EXPECT_NEAR(result(i, 3), i >= 5 && i < 12 ? image(i, 3) : -1, 1e-6);
  }
}

TEST(Resample, SameBitsOnAnyNumberOfThreads) {
  const auto image = noise_image(turned_raster<2>({130, 97}));
  DisplacementField<2> field(image.raster());
  for (std::size_t p = 0; p < field.values().size(); ++p) {
    field.values()[p] = {std::sin(0.01 * static_cast<double>(p)), 1.5};
  }
  std::vector<std::vector<float>> results;
  for (int threads : {1, 2, 8}) {
    set_num_threads(threads);
    results.push_back(resample(*make_interpolator(image), image.raster(), row_map(field)).values());
  }
  set_num_threads(0);
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

}  // namespace
}  // namespace crease
