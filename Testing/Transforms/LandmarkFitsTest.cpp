#include "Transforms/LandmarkFits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "Core/Error.h"
#include "Testing/Transforms/SampleSplines.h"

namespace crease {
namespace {

template <int Dim>
std::vector<Point<Dim>> scattered(int count) {
  const auto columns = testing::Numbers(7).columns<Dim>(count, 50);
  std::vector<Point<Dim>> points;
  for (int n = 0; n < count; ++n) points.push_back(columns.col(n));
  return points;
}

template <int Dim, typename Map>
std::vector<Point<Dim>> images(const std::vector<Point<Dim>>& points, const Map& map) {
  std::vector<Point<Dim>> moved;
  for (const auto& p : points) moved.push_back(map(p));
  return moved;
}

/// Sum of squared distances after the transform.
template <int Dim>
double misfit(const Transform<Dim>& transform, const std::vector<Point<Dim>>& p,
              const std::vector<Point<Dim>>& q) {
  double sum = 0;
  for (std::size_t j = 0; j < p.size(); ++j) sum += (transform.map(p[j]) - q[j]).squaredNorm();
  return sum;
}

/// No small change of the parameters makes the fit better.
template <int Dim>
void expect_minimum(Transform<Dim>& transform, const std::vector<Point<Dim>>& p,
                    const std::vector<Point<Dim>>& q) {
  const double best = misfit(transform, p, q);
  const Eigen::VectorXd at = transform.parameters();
  for (Eigen::Index k = 0; k < at.size(); ++k) {
    for (double step : {1e-4, -1e-4}) {
      Eigen::VectorXd changed = at;
      changed[k] += step;
      transform.set_parameters(changed);
      EXPECT_GT(misfit(transform, p, q), best);
    }
  }
}

template <int Dim>
void recovers_rigid_and_affine() {
  const auto p = scattered<Dim>(6);
  AffineMap<Dim> rigid{testing::turned<Dim>(2.9), Vector<Dim>::Constant(7)};
  const auto fit = fit_rigid<Dim>(p, images(p, rigid));
  EXPECT_LT((fit.rotation() - rigid.linear).norm(), 1e-12);
  EXPECT_LT((fit.affine_map().offset - rigid.offset).norm(), 1e-11);

  AffineMap<Dim> affine{rigid.linear, rigid.offset};
  affine.linear(0, 1) += 0.5;
  affine.linear(1, 1) *= -2;
  const auto affine_fit = fit_affine<Dim>(p, images(p, affine));
  EXPECT_LT((affine_fit.affine_map().linear - affine.linear).norm(), 1e-12);
  EXPECT_LT((affine_fit.affine_map().offset - affine.offset).norm(), 1e-11);
}

template <int Dim>
void fits_are_least_squares() {
  const auto p = scattered<Dim>(8);
  testing::Numbers numbers(13);
  const auto q = images(p, [&](const Point<Dim>& x) -> Point<Dim> {
    return testing::turned<Dim>(0.4) * x + numbers.columns<Dim>(1, 5);
  });
  auto rigid = fit_rigid<Dim>(p, q);
  EXPECT_NEAR(rigid.rotation().determinant(), 1, 1e-12);
  expect_minimum<Dim>(rigid, p, q);
  auto affine = fit_affine<Dim>(p, q);
  expect_minimum<Dim>(affine, p, q);
}

}  // namespace

TEST(LandmarkFits, RecoverRigidAndAffineMaps) {
  recovers_rigid_and_affine<2>();
  recovers_rigid_and_affine<3>();
}

TEST(LandmarkFits, AreLeastSquares) {
  fits_are_least_squares<2>();
  fits_are_least_squares<3>();
}

// Mirrored landmarks must not give a mirror.
TEST(LandmarkFits, RigidIsNeverAReflection) {
  const auto p = scattered<2>(5);
  const auto q = images(p, [](const Point<2>& x) { return Point<2>(-x[0], x[1]); });
  EXPECT_NEAR(fit_rigid<2>(p, q).rotation().determinant(), 1, 1e-12);
}

TEST(LandmarkFits, TwoLandmarksGiveARigidMapInThePlane) {
  const std::vector<Point<2>> p = {{0, 0}, {10, 0}}, q = {{5, 5}, {5, 15}};
  const auto fit = fit_rigid<2>(p, q);
  EXPECT_LT(misfit<2>(fit, p, q), 1e-20);
}

TEST(LandmarkFits, RefuseDegenerateLandmarks) {
  const std::vector<Point<2>> line = {{0, 0}, {1, 1}, {2, 2}, {5, 5}};
  EXPECT_THAT([&] { fit_affine<2>(line, line); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("on one line")));
  const std::vector<Point<2>> same = {{3, 3}, {3, 3}};
  EXPECT_THROW(fit_rigid<2>(same, same), InvalidInput);
  const std::vector<Point<3>> line3 = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
  EXPECT_THAT([&] { fit_rigid<3>(line3, line3); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("on one line")));
  EXPECT_THROW(fit_rigid<2>(line, same), InvalidInput);
  const std::vector<Point<2>> bad = {{0, 0}, {1, std::nan("")}};
  EXPECT_THROW(fit_rigid<2>(bad, bad), InvalidInput);
}

}  // namespace crease
