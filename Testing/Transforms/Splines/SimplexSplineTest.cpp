#include "Transforms/Splines/SimplexSpline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "Core/Error.h"
#include "Testing/Transforms/Splines/JetErrors.h"
#include "Testing/Transforms/Splines/ReferenceVectors.h"

namespace crease {
namespace {

const std::vector<Vector<2>> kFlag = {{1.0, 0.375}, {-0.25, 1.0}};

template <int Dim>
void check_reference_cases() {
  const auto files = testing::reference_vectors("simplex_spline", Dim);
  if (files.empty()) GTEST_SKIP() << "no test vectors";
  int checked = 0;
  for (const auto& file : files) {
    testing::JetErrors errors;
    for (const auto& c : file["cases"]) {
      if (c["dim"] != Dim) continue;
      ++checked;
      const auto knots = testing::points<Dim>(c["knots"]);
      const auto directions = testing::points<Dim>(c["directions"]);
      const auto jet = simplex_spline<Dim>(knots, testing::point<Dim>(c["u"]), directions);
      errors.add(jet, std::stod(c["M"].get<std::string>()), testing::numbers(c["grad"]),
                 testing::numbers(c["hess"]));
    }
    errors.expect_small(file["name"]);
  }
  EXPECT_GT(checked, 0);
}

TEST(SimplexSpline, MatchesExactValuesInThePlane) { check_reference_cases<2>(); }
TEST(SimplexSpline, MatchesExactValuesInSpace) { check_reference_cases<3>(); }

// With all knots at the corners M is the Bernstein polynomial n!/(b0! b1! b2!) lambda^beta over det V.
TEST(SimplexSpline, IsBernsteinPolynomialWhenKnotsCollapse) {
  const std::array<Point<2>, 3> v = {Point<2>(0, 0), Point<2>(4, 1), Point<2>(1, 5)};
  const std::vector<Point<2>> knots = {v[0], v[0], v[0], v[1], v[1], v[2]};  // beta = (2, 1, 0)
  const double l0 = 0.3, l1 = 0.5, l2 = 0.2, det = 19.0;
  const auto jet = simplex_spline<2>(knots, l0 * v[0] + l1 * v[1] + l2 * v[2], kFlag);
  EXPECT_NEAR(jet.value, 3.0 * l0 * l0 * l1 / det, 1e-15);
}

// M is the density of the projection of a uniform density on a simplex, n! / (n + 2)! in all: its
// integral over a fine grid of midpoints is that of the definition.
TEST(SimplexSpline, IntegralIsThatOfTheNormalisation) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int degree = 1; degree <= 4; ++degree) {
    std::vector<Point<2>> knots;
    for (int i = 0; i < degree + 3; ++i) knots.emplace_back(unit(random), unit(random));
    const int cells = 100;
    double sum = 0.0;
    for (int i = 0; i < cells; ++i) {
      for (int j = 0; j < cells; ++j) {
        const Point<2> u((i + 0.5) / cells, (j + 0.5) / cells);
        sum += simplex_spline<2>(knots, u, kFlag).value;
      }
    }
    sum /= cells * cells;
    EXPECT_NEAR(sum * (degree + 1) * (degree + 2), 1.0, 2e-2) << "degree " << degree;
  }
}

TEST(SimplexSpline, DerivativesMatchCentralDifferencesInSpace) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<Point<3>> knots;
  for (int i = 0; i < 8; ++i) knots.emplace_back(normal(random), normal(random), normal(random));
  Point<3> u = Point<3>::Zero();
  for (const auto& knot : knots) u += knot / 8.0;
  const auto flag = flag_towards<3>(Point<3>(1.0, 0.3, 0.2), u);
  const auto jet = simplex_spline<3>(knots, u, flag);
  ASSERT_GT(jet.value, 0.0);
  const double step = 1e-5;
  for (int a = 0; a < 3; ++a) {
    const Point<3> e = step * Point<3>(Point<3>::Unit(a));
    const auto plus = simplex_spline<3>(knots, u + e, flag);
    const auto minus = simplex_spline<3>(knots, u - e, flag);
    EXPECT_NEAR(jet.gradient[a], (plus.value - minus.value) / (2 * step), 1e-7);
    const Vector<3> row = (plus.gradient - minus.gradient) / (2 * step);
    for (int b = 0; b < 3; ++b) {
      EXPECT_NEAR(jet.hessian[second_derivative_index<3>(a, b)], row[b], 1e-4);
    }
  }
}

TEST(SimplexSpline, VanishesWithoutVolume) {
  const std::vector<Point<2>> knots = {{0, 0}, {1, 1}, {2, 2}, {3, 3}};
  EXPECT_EQ(simplex_spline<2>(knots, Point<2>(1.5, 1.5), kFlag).value, 0.0);
}

TEST(SimplexSpline, RefusesWrongInput) {
  const std::vector<Point<2>> two = {{0, 0}, {1, 1}};
  EXPECT_THROW(simplex_spline<2>(two, Point<2>(0, 0), kFlag), InvalidInput);
  const std::vector<Point<2>> nan = {{0, 0}, {1, std::nan("")}, {2, 0}};
  EXPECT_THROW(simplex_spline<2>(nan, Point<2>(0, 0), kFlag), InvalidInput);
}

}  // namespace
}  // namespace crease
