#include "Transforms/LandmarkFits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "Core/Error.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/Energies/BendingEnergy.h"

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
  auto similarity = fit_similarity<Dim>(p, q);
  expect_minimum<Dim>(similarity, p, q);
  auto affine = fit_affine<Dim>(p, q);
  expect_minimum<Dim>(affine, p, q);
}

/// Landmarks near a curved map.
template <int Dim>
std::vector<Point<Dim>> bent(const std::vector<Point<Dim>>& points, double noise) {
  testing::Numbers numbers(21);
  return images(points, [&](const Point<Dim>& x) -> Point<Dim> {
    Point<Dim> y = x + numbers.columns<Dim>(1, noise);
    y[0] += 4 * std::sin(0.05 * x[1]);
    y[1] += 0.002 * x[0] * x[0];
    return y;
  });
}

/// sum_j |T(p_j) - q_j|^2 / s_j^2 + lambda int sum_ab |T_,ab|^2 dx.
template <int Dim>
double smoothing_cost(const SplineTransform<Dim>& transform, const std::vector<Point<Dim>>& p,
                      const std::vector<Point<Dim>>& q, const std::vector<double>& sigma,
                      double lambda) {
  double sum = 2 * lambda *
               BendingEnergy<Dim>(transform.basis())
                   .evaluate(transform.control_points(), 1, nullptr, nullptr);
  for (std::size_t j = 0; j < p.size(); ++j) {
    if (sigma[j] > 0) sum += (transform.map(p[j]) - q[j]).squaredNorm() / (sigma[j] * sigma[j]);
  }
  return sum;
}

template <int Dim>
void smoothed_thin_plate_is_a_minimum() {
  const auto p = scattered<Dim>(15);
  const auto q = bent(p, 2);
  std::vector<double> sigma(p.size(), 1.5);
  sigma[4] = 0;
  sigma[7] = 0.2;
  const double lambda = Dim == 2 ? 30 : 1;
  auto fit = fit_thin_plate<Dim>(p, q, sigma, lambda);
  EXPECT_LT((fit.map(p[4]) - q[4]).norm(), 1e-10);
  EXPECT_GT((fit.map(p[3]) - q[3]).norm(), 0.1);
  const double best = smoothing_cost<Dim>(fit, p, q, sigma, lambda);
  const ControlPoints<Dim> at = fit.control_points();
  for (Eigen::Index j = 0; j < at.cols(); ++j) {
    if (sigma[j] == 0) continue;
    for (double step : {1e-3, -1e-3}) {
      ControlPoints<Dim> changed = at;
      changed(1, j) += step;
      fit.set_control_points(changed);
      EXPECT_GT(smoothing_cost<Dim>(fit, p, q, sigma, lambda), best);
    }
  }
}

template <int Dim>
void recovers_similarities() {
  const auto p = scattered<Dim>(6);
  const AffineMap<Dim> truth{1.37 * testing::turned<Dim>(2.9), Vector<Dim>::Constant(7)};
  const auto fit = fit_similarity<Dim>(p, images(p, truth));
  EXPECT_LT((fit.affine_map().linear - truth.linear).norm(), 1e-12);
  EXPECT_LT((fit.affine_map().offset - truth.offset).norm(), 1e-11);
  EXPECT_NEAR(fit.scale(), 1.37, 1e-13);
}

}  // namespace

TEST(LandmarkFits, RecoverSimilarities) {
  recovers_similarities<2>();
  recovers_similarities<3>();
}

TEST(LandmarkFits, SimilarityIsNeverAReflection) {
  const auto p = scattered<2>(5);
  const auto q =
      images(p, [](const Point<2>& x) { return Point<2>(-2 * x[0] - 0.5 * x[1], 2 * x[1]); });
  EXPECT_GT(fit_similarity<2>(p, q).affine_map().linear.determinant(), 0);
}

TEST(LandmarkFits, ThinPlatesMeetExactLandmarks) {
  for (const double scale : {1e-3, 1.0, 1e4}) {  // whatever the unit of length
    const auto p = images(scattered<2>(40), [&](const Point<2>& x) { return scale * x; });
    const auto q = images(bent(scattered<2>(40), 3), [&](const Point<2>& x) { return scale * x; });
    EXPECT_LT(std::sqrt(misfit<2>(fit_thin_plate<2>(p, q), p, q)), 1e-10 * 100 * scale);
  }
  const auto p = scattered<3>(40), q = bent(p, 3);
  EXPECT_LT(misfit<3>(fit_thin_plate<3>(p, q), p, q), 1e-18);
}

TEST(LandmarkFits, ThinPlatesReproduceAffineMapsEverywhere) {
  const auto p = scattered<3>(9);
  AffineMap<3> affine{1.2 * testing::turned<3>(0.8), Vector<3>(5, -2, 40)};
  affine.linear(0, 2) = 0.4;
  const auto fit = fit_thin_plate<3>(p, images(p, affine));
  const Point<3> far(900, -700, 300);
  EXPECT_LT((fit.map(far) - affine(far)).norm(), 1e-9);
  EXPECT_LT((fit.spatial_jacobian(far) - affine.linear).norm(), 1e-12);
}

TEST(LandmarkFits, SmoothedThinPlatesAreMinima) {
  smoothed_thin_plate_is_a_minimum<2>();
  smoothed_thin_plate_is_a_minimum<3>();
}

// Without lambda soft landmarks are missed by what they are uncertain.
TEST(LandmarkFits, ThinPlatesMissSoftLandmarksByTheirUncertainty) {
  const auto p = scattered<2>(60);
  const auto q = bent(p, 1);
  std::vector<double> sigma(p.size(), std::sqrt(1.0 / 3));  // of numbers in [-1, 1]
  sigma[0] = 0;
  const auto fit = fit_thin_plate<2>(p, q, sigma);
  const double found = smoothing_cost<2>(fit, p, q, sigma, 0);
  EXPECT_LE(found, 2 * 59);
  EXPECT_GE(found, 0.99 * 2 * 59);
  // Nearer to the map that the landmarks were drawn from than the exact spline is.
  const auto truth = bent(p, 0);
  EXPECT_LT(misfit<2>(fit, p, truth), 0.6 * misfit<2>(fit_thin_plate<2>(p, q), p, truth));
  // Landmarks that an affine map meets well enough give that map.
  const std::vector<double> loose(p.size(), 100);
  const auto flat = fit_thin_plate<2>(p, q, loose);
  EXPECT_LT(BendingEnergy<2>(flat.basis()).evaluate(flat.control_points(), 1, nullptr, nullptr),
            1e-9);
}

TEST(LandmarkFits, ThinPlatesNameLandmarksThatCoincide) {
  auto p = scattered<2>(8);
  p[6] = p[2];
  EXPECT_THAT([&] { fit_thin_plate<2>(p, scattered<2>(8)); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("2 and 6 coincide")));
  const std::vector<Point<2>> line = {{0, 0}, {1, 1}, {2, 2}, {5, 5}};
  EXPECT_THAT([&] { fit_thin_plate<2>(line, line); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("lie on one line")));
  const auto q = scattered<2>(5);
  EXPECT_THROW(fit_thin_plate<2>(q, q, std::vector<double>(4, 1.0)), InvalidInput);
  EXPECT_THROW(fit_thin_plate<2>(q, q, std::vector<double>(5, -1.0)), InvalidInput);
  EXPECT_THROW(fit_thin_plate<2>(q, q, std::vector<double>(5, 1.0), -1.0), InvalidInput);
}

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
