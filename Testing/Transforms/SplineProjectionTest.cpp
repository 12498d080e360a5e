#include "Transforms/SplineProjection.h"

#include <gtest/gtest.h>

#include "Core/Parallel.h"
#include "Testing/Transforms/SampleSplines.h"

namespace crease {
namespace {

Vector<2> wave(const Point<2>& x) { return {std::sin(x[0]), std::cos(x[0] + 0.5 * x[1])}; }

}  // namespace

TEST(SplineProjection, FindsASplineOfItsOwnSpace) {
  const auto basis = testing::small_basis<2>();
  SplineTransform<2> spline(basis);
  spline.set_control_points(testing::Numbers().columns<2>(basis->num_control_points()));
  const auto fit =
      project<2>(*basis, [&](const Point<2>& x) -> Vector<2> { return spline.map(x) - x; });
  EXPECT_LT((fit.control_points - spline.control_points()).norm(), 1e-10);
  EXPECT_LT(fit.max_error, 1e-12);
}

// Cubic splines approximate smooth functions with order 4: halving the spans divides the error by 16.
TEST(SplineProjection, ConvergesWithOrderFour) {
  double previous = 0;
  for (int spans : {12, 24, 48}) {
    const auto basis = testing::box_basis<2>(spans, 6.0);
    const auto fit = project<2>(*basis, wave);
    EXPECT_GE(fit.max_error, fit.rms_error);
    if (previous > 0) EXPECT_NEAR(previous / fit.rms_error, 16, 3);
    previous = fit.rms_error;
  }
}

TEST(SplineProjection, TransfersToRefinedLatticesByKnotInsertion) {
  const auto coarse = testing::small_basis<3>();
  const auto fine = coarse->refined().refined();
  const ControlPoints<3> phi = testing::Numbers().columns<3>(coarse->num_control_points());
  const auto moved = transfer<3>(coarse, phi, fine);
  EXPECT_EQ(moved.max_error, 0);
  const ControlPoints<3> expected =
      coarse->refined().refine_control_points(coarse->refine_control_points(phi));
  EXPECT_EQ(moved.control_points, expected);
}

TEST(SplineProjection, TransfersToOtherSpacesByProjection) {
  const std::shared_ptr<const SplineBasis<2>> from = testing::box_basis<2>(5, 4.0, 2);
  const auto to = testing::box_basis<2>(13, 4.0, 3);
  const ControlPoints<2> phi = testing::Numbers().columns<2>(from->num_control_points());
  const auto moved = transfer<2>(from, phi, *to);
  EXPECT_GT(moved.max_error, 1e-6);  // the spaces do not nest
  EXPECT_LT(moved.max_error, 0.05);
  EXPECT_LT(moved.rms_error, moved.max_error);
}

TEST(SplineProjection, SameBytesOnAnyNumberOfThreads) {
  const auto basis = testing::small_basis<2>();
  set_num_threads(1);
  const auto one = project<2>(*basis, wave).control_points;
  set_num_threads(4);
  const auto four = project<2>(*basis, wave).control_points;
  set_num_threads(0);
  EXPECT_EQ(one, four);
}

}  // namespace crease
