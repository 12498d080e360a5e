#include "Transforms/InverseMap.h"

#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Testing/Transforms/SampleBases.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/JacobianMap.h"

namespace crease {
namespace {

template <int Dim>
Raster<Dim> unit_raster(int size) {
  Raster<Dim> raster;
  raster.size.fill(size);
  return raster;
}

template <int Dim>
SplineTransform<Dim> random_warp(std::shared_ptr<const SplineBasis<Dim>> basis, double amplitude) {
  SplineTransform<Dim> transform(std::move(basis));
  transform.set_control_points(
      testing::Numbers(3).columns<Dim>(transform.basis().num_control_points(), amplitude));
  return transform;
}

/// A spline over the raster that moves points by up to some pixels without folding.
template <int Dim>
SplineTransform<Dim> smooth_warp(const Raster<Dim>& raster, double amplitude) {
  return random_warp<Dim>(testing::tensor_over<Dim>(raster.bounds(), 4, 3), amplitude);
}

template <int Dim>
void inverts(const Transform<Dim>& transform, const Raster<Dim>& raster) {
  ASSERT_EQ(jacobian_map<Dim>(transform, raster).statistics().num_folded, 0);
  const InverseMap<Dim> inverse(transform, raster);
  for (std::int64_t r = 0; r < raster.num_rows(); ++r) {
    for (int i = static_cast<int>(r % 5); i < raster.size[0]; i += 5) {
      const Point<Dim> x = raster.row_start(r) + double(i) * raster.index_to_point().col(0);
      const Point<Dim> y = transform.map(x);
      const Point<Dim> back = inverse(y);
      ASSERT_LT((transform.map(back) - y).norm(), 1e-6);
      ASSERT_LT((back - x).norm(), 1e-5);
    }
  }
}

/// The area within T(border of a box).
double moved_area(const Transform<2>& transform, const Box<2>& box) {
  std::vector<Point<2>> border;
  constexpr int kSteps = 2000;
  const std::array<Point<2>, 5> corners = {box.lower, Point<2>(box.upper[0], box.lower[1]),
                                           box.upper, Point<2>(box.lower[0], box.upper[1]),
                                           box.lower};
  for (int side = 0; side < 4; ++side) {
    for (int n = 0; n < kSteps; ++n) {
      border.push_back(transform.map(corners[side] +
                                     (corners[side + 1] - corners[side]) * (double(n) / kSteps)));
    }
  }
  return signed_area(border);
}

}  // namespace

TEST(InverseMap, UndoesASmoothWarp) {
  inverts<2>(smooth_warp(unit_raster<2>(48), 4.0), unit_raster<2>(48));
  inverts<3>(smooth_warp(unit_raster<3>(16), 1.0), unit_raster<3>(16));
}

TEST(InverseMap, UndoesTriangularSplinesAndCreases) {
  const auto raster = unit_raster<2>(48);
  inverts<2>(random_warp<2>(testing::triangles_over(raster.bounds(), {.degree = 3}), 1.5), raster);
  inverts<2>(random_warp<2>(testing::triangles_over(raster.bounds(), {.degree = 2}), 1.5), raster);
  inverts<2>(random_warp<2>(testing::creased_over(raster.bounds()), 0.6), raster);
}

TEST(InverseMap, UndoesALargeAffineMapFromACoarseGrid) {
  AffineMap<2> map;
  map.linear << 0.5, -2, 2, 0.5;
  map.offset = {300, -70};
  const AffineTransform<2> transform(map);
  const InverseMap<2> inverse(transform, unit_raster<2>(3));
  for (const auto& x : {Point<2>(0, 0), Point<2>(1.3, 0.2), Point<2>(-50, 80)}) {
    EXPECT_LT((inverse(transform.map(x)) - x).norm(), 1e-6);
  }
}

// A map that flattens everything onto a line reaches no point beside it.
TEST(InverseMap, MarksAndCountsWhatItCannotReach) {
  AffineMap<2> flat;
  flat.linear << 1, 0, 0, 0;
  const AffineTransform<2> transform(flat);
  const auto raster = unit_raster<2>(6);
  const auto field = invert<2>(transform, raster, raster);
  EXPECT_EQ(field.num_unresolved, 30);  // all rows but the one with y = 0
  EXPECT_TRUE(field.displacements.col(7).array().isNaN().all());
  EXPECT_LT(field.displacements.col(3).norm() - 5, 1e-6);
  EXPECT_TRUE(InverseMap<2>(transform, raster)({std::nan(""), 0}).array().isNaN().all());
}

TEST(InverseMap, FieldIsTheInverseOnARaster) {
  const auto raster = unit_raster<2>(32);
  const auto transform = smooth_warp<2>(raster, 2.0);
  set_num_threads(1);
  const auto field = invert<2>(transform, raster, raster);
  set_num_threads(4);
  const auto again = invert<2>(transform, raster, raster);
  set_num_threads(0);
  EXPECT_EQ(field.num_unresolved, 0);
  EXPECT_EQ(field.displacements, again.displacements);
  for (int n = 0; n < raster.num_samples(); ++n) {
    const Point<2> y(n % 32, n / 32);
    EXPECT_LT((transform.map(y + field.displacements.col(n)) - y).norm(), 1e-6);
  }
}

TEST(InverseMap, RefusesAnEmptyGrid) {
  EXPECT_THROW(InverseMap<2>(AffineTransform<2>(), Raster<2>()), InvalidInput);
}

// The integral of det grad T is the area that the moved border encloses.
TEST(JacobianMap, IntegralIsTheAreaOfTheImage) {
  const auto raster = unit_raster<2>(64);
  const auto box = raster.bounds();
  for (const auto& transform :
       {smooth_warp<2>(raster, 3.0), random_warp<2>(testing::triangles_over(box, {}), 1.5),
        random_warp<2>(testing::creased_over(box), 0.6)}) {
    const auto statistics = jacobian_map<2>(transform, raster).statistics();
    EXPECT_EQ(statistics.num_samples, 64 * 64);
    const double area = moved_area(transform, box);
    EXPECT_GT(std::abs(area - 64 * 64), 1e-3 * area);
    EXPECT_NEAR(statistics.mean * 64 * 64, area, 1e-3 * area);
    EXPECT_LT(statistics.minimum, statistics.mean);
    EXPECT_GT(statistics.maximum, statistics.mean);
  }
}

TEST(JacobianMap, FindsFoldsAndHonoursTheMask) {
  auto raster = unit_raster<2>(10);
  raster.spacing = {0.5, 2.0};
  SplineTransform<2> transform(testing::box_basis<2>(1, 100.0, 2));
  // u_x = -0.26 x^2, so det = 1 - 0.52 x folds from x = 2 on; x runs over 0, 0.5, .., 4.5.
  ControlPoints<2> phi = ControlPoints<2>::Zero(2, 9);
  const auto greville = transform.basis().greville_points();
  for (int i = 0; i < 9; ++i) {
    // B-spline coefficients of x^2 for degree 2: the product of the two inner knots of each function.
    phi(0, i) = -0.26 * (greville(0, i) - 50) * (greville(0, i) + 50);
  }
  transform.set_control_points(phi);
  const auto map = jacobian_map<2>(transform, raster);
  const auto all = map.statistics();
  EXPECT_EQ(all.num_folded, 60);
  EXPECT_DOUBLE_EQ(all.folded_measure, 60.0);
  EXPECT_NEAR(all.minimum, 1 - 0.52 * 4.5, 1e-12);
  EXPECT_NEAR(all.minimum_at[0], 4.5, 1e-12);
  std::vector<std::uint8_t> mask(100, 0);
  mask[0] = mask[9] = 1;
  const auto two = map.statistics(mask);
  EXPECT_EQ(two.num_samples, 2);
  EXPECT_EQ(two.num_folded, 1);
  EXPECT_NEAR(two.mean, 0.5 * (1 + 1 - 0.52 * 4.5), 1e-12);
  EXPECT_THROW(map.statistics(std::vector<std::uint8_t>(3)), InvalidInput);
  EXPECT_EQ(map.statistics(std::vector<std::uint8_t>(100, 0)).num_samples, 0);
}

}  // namespace crease
