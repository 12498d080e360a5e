#include "Registration/Elastic/DisplacementSamples.h"

#include <gtest/gtest.h>

#include "Testing/Registration/Elastic/RefinementScene.h"

namespace crease {
namespace {

Vector<2> read(const DisplacementSamples& samples, const Point<2>& y) {
  return {samples.components[0]->evaluate(y).value, samples.components[1]->evaluate(y).value};
}

/// Farthest that the samples lead off T, at points off the pixels' centres.
double largest_error(const DisplacementSamples& samples, const SplineTransform<2>& transform,
                     const Box<2>& box) {
  double largest = 0;
  constexpr int kPoints = 200;
  for (int j = 0; j < kPoints; ++j) {
    for (int i = 0; i < kPoints; ++i) {
      const Point<2> y =
          box.lower + box.size().cwiseProduct(Vector<2>(i + 0.31, j + 0.43)) / kPoints;
      largest = std::max(largest, (y + read(samples, y) - transform.map(y)).norm());
    }
  }
  return largest;
}

}  // namespace

TEST(DisplacementSamples, TakesWideStepsWhereTheMapIsSmooth) {
  const auto raster = testing::raster_of<2>(96);
  const auto basis = testing::tensor_over<2>(raster.bounds(), 2, 3);
  SplineTransform<2> transform(basis);
  transform.set_control_points(testing::Numbers(2).columns<2>(basis->num_control_points(), 0.5));
  const auto samples = sample_displacement(transform, *basis->bind(raster));
  EXPECT_EQ(samples.step, 4);
  EXPECT_LE(samples.largest_error, 0.01);
  EXPECT_LE(largest_error(samples, transform, raster.bounds()), 0.01);
}

TEST(DisplacementSamples, FollowsCreasesToATenthOfTheJump) {
  const auto raster = testing::raster_of<2>(96);
  const auto basis = testing::creased_over(raster.bounds(), 2);
  SplineTransform<2> transform(basis);
  transform.set_control_points(testing::Numbers(2).columns<2>(basis->num_control_points(), 2));
  const auto samples = sample_displacement(transform, *basis->bind(raster));
  EXPECT_EQ(samples.step, 1);
  EXPECT_LE(samples.largest_error, 1e-4);  // at the pixels: single precision
  double slope = 0;                        // the jump is twice the largest slope at most
  for (int j = 1; j < 95; ++j) {
    for (int i = 1; i < 95; ++i) {
      slope = std::max(slope, (transform.spatial_jacobian({i, j}) - Matrix<2>::Identity()).norm());
    }
  }
  EXPECT_LE(largest_error(samples, transform, raster.bounds()), 0.1 * 2 * slope);
}

TEST(DisplacementSamples, ContinuesAsTheTransformDoes) {
  const testing::RefinementScene scene;
  const auto samples =
      sample_displacement(*scene.start, *scene.basis->bind(scene.raster), {.margin_mm = 6});
  for (double beyond : {0.5, 2.0, 5.0}) {
    for (int n = 0; n < 40; ++n) {
      const double along = 10 + 1.9 * n;
      for (const Point<2>& y : {Point<2>(scene.box.lower[0] - beyond, along),
                                Point<2>(along, scene.box.upper[1] + beyond)}) {
        // The continuation's gradient has kinks, which grow with the distance from the border.
        EXPECT_LT((y + read(samples, y) - scene.start->map(y)).norm(), 0.05 * (1 + beyond))
            << y.transpose();
      }
    }
  }
  // Far away nothing is asked for, but that it stays finite and calm.
  EXPECT_LT(read(samples, {-500, 40}).norm(), 30);
}

TEST(DisplacementSamples, KeepsTheAffinePart) {
  const auto raster = testing::raster_of<2>(64);
  const auto basis = testing::tensor_over<2>(raster.bounds(), 3, 2);
  AffineMap<2> affine;
  affine.linear << 1.1, 0.2, -0.1, 0.9;
  affine.offset << 3, -2;
  SplineTransform<2> transform(basis, affine);
  transform.set_control_points(testing::Numbers(2).columns<2>(basis->num_control_points(), 1));
  const auto samples = sample_displacement(transform, *basis->bind(raster));
  EXPECT_LE(largest_error(samples, transform, raster.bounds()), 0.02);
}

}  // namespace crease
