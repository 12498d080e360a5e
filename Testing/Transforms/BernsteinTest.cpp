#include "Transforms/Bernstein.h"

#include <gtest/gtest.h>

#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/Splines/BPatchIndices.h"
#include "Transforms/Splines/TensorBSplineSegments.h"

namespace crease {
namespace {

using testing::Numbers;

double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

/// By the definition.
template <int Dim>
double value(const BernsteinSimplex<Dim>& p, const std::array<double, Dim + 1>& lambda) {
  const auto indices = multi_indices<Dim>(p.degree());
  double sum = 0;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    double term = p.coefficients()[static_cast<Eigen::Index>(i)] * factorial(p.degree());
    for (int j = 0; j <= Dim; ++j) {
      term *= std::pow(lambda[j], indices[i][j]) / factorial(indices[i][j]);
    }
    sum += term;
  }
  return sum;
}

template <int Dim>
double value(const BernsteinBox<Dim>& p, const Vector<Dim>& t) {
  double sum = 0;
  for (Eigen::Index n = 0; n < p.coefficients().size(); ++n) {
    double term = p.coefficients()[n];
    Eigen::Index rest = n;
    for (int a = 0; a < Dim; ++a) {
      const int d = p.degrees()[a], k = static_cast<int>(rest % (d + 1));
      rest /= d + 1;
      term *= factorial(d) / factorial(k) / factorial(d - k) * std::pow(t[a], k) *
              std::pow(1 - t[a], d - k);
    }
    sum += term;
  }
  return sum;
}

template <int Dim>
std::array<double, Dim + 1> barycentric(Numbers& numbers) {
  std::array<double, Dim + 1> lambda;
  double sum = 0;
  for (double& l : lambda) sum += l = 1.1 + numbers();
  for (double& l : lambda) l /= sum;
  return lambda;
}

template <int Dim>
BernsteinSimplex<Dim> random_simplex(int degree, unsigned seed) {
  return {degree, Numbers(seed).columns<1>(num_multi_indices<Dim>(degree)).transpose()};
}

template <int Dim>
BernsteinBox<Dim> random_box(const std::array<int, Dim>& degrees, unsigned seed) {
  int count = 1;
  for (int d : degrees) count *= d + 1;
  return {degrees, Numbers(seed).columns<1>(count).transpose()};
}

constexpr double kRounding = 1e-13;  // of values up to 1

template <int Dim>
void expect_simplex_algebra() {
  Numbers numbers(3);
  for (int a = 0; a <= 4; ++a) {
    for (int b = 0; b <= 4; ++b) {
      const auto p = random_simplex<Dim>(a, 1 + a), q = random_simplex<Dim>(b, 9 + b);
      const auto x = barycentric<Dim>(numbers);
      EXPECT_NEAR(value<Dim>(p * q, x), value<Dim>(p, x) * value<Dim>(q, x), kRounding);
    }
    const auto p = random_simplex<Dim>(a, 4 + a);
    for (int j = 0; j <= Dim; ++j) {
      for (int k = 0; k <= Dim; ++k) {
        if (j == k) continue;
        const auto [first, second] = p.split(j, k);
        const auto x = barycentric<Dim>(numbers);
        auto y = x;  // the point x of the half with m for corner k
        y[j] += 0.5 * x[k];
        y[k] = 0.5 * x[k];
        EXPECT_NEAR(value<Dim>(first, x), value<Dim>(p, y), kRounding);
        y = x;
        y[k] += 0.5 * x[j];
        y[j] = 0.5 * x[j];
        EXPECT_NEAR(value<Dim>(second, x), value<Dim>(p, y), kRounding);
      }
      std::array<double, Dim + 1> corner{};
      corner[j] = 1;
      EXPECT_NEAR(p.at_corner(j), value<Dim>(p, corner), kRounding);
    }
  }
}

template <int Dim>
void expect_box_algebra(const std::array<int, Dim>& da, const std::array<int, Dim>& db) {
  Numbers numbers(5);
  const auto p = random_box<Dim>(da, 2), q = random_box<Dim>(db, 3);
  const Vector<Dim> t = (numbers.columns<Dim>(1).array() + 1) / 2;
  EXPECT_NEAR(value<Dim>(p * q, t), value<Dim>(p, t) * value<Dim>(q, t), kRounding);
  for (int a = 0; a < Dim; ++a) {
    const auto [lower, upper] = p.split(a);
    Vector<Dim> in_lower = t, in_upper = t;
    in_lower[a] = 0.5 * t[a];
    in_upper[a] = 0.5 + 0.5 * t[a];
    EXPECT_NEAR(value<Dim>(lower, t), value<Dim>(p, in_lower), kRounding);
    EXPECT_NEAR(value<Dim>(upper, t), value<Dim>(p, in_upper), kRounding);
  }
  for (int corner = 0; corner < 1 << Dim; ++corner) {
    Vector<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = corner >> a & 1;
    EXPECT_NEAR(p.at_corner(corner), value<Dim>(p, x), kRounding);
  }
}

}  // namespace

TEST(Bernstein, ProductsHalvesAndCornersOnSimplices) {
  expect_simplex_algebra<2>();
  expect_simplex_algebra<3>();
}

TEST(Bernstein, ProductsHalvesAndCornersOnBoxes) {
  expect_box_algebra<2>({2, 3}, {3, 2});
  expect_box_algebra<2>({0, 4}, {5, 1});
  expect_box_algebra<3>({2, 3, 3}, {3, 2, 3});
  expect_box_algebra<3>({1, 0, 2}, {4, 3, 1});
}

TEST(Bernstein, CoefficientsFollowFromValuesAtDomainPoints) {
  const std::array<Point<2>, 3> corners = {{{1, 2}, {4, 1}, {2, 5}}};
  for (int degree = 0; degree <= 5; ++degree) {
    const auto p = random_simplex<2>(degree, 7);
    const auto indices = multi_indices<2>(degree);
    const auto points = domain_points<2>(corners, degree);
    Eigen::VectorXd values(std::ssize(points));
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::array<double, 3> lambda = {1.0 / 3, 1.0 / 3, 1.0 / 3};
      Point<2> x = Point<2>::Zero();
      for (int j = 0; j < 3; ++j) {
        if (degree > 0) lambda[j] = indices[i][j] / static_cast<double>(degree);
        x += lambda[j] * corners[j];
      }
      EXPECT_LT((points[i] - x).norm(), 1e-14);
      values[static_cast<Eigen::Index>(i)] = value<2>(p, lambda);
    }
    EXPECT_LT((coefficients_from_values<2>(degree) * values - p.coefficients()).norm(), 1e-12);
  }
}

// The growth of errors that the header tells.
TEST(Bernstein, ValuesAtDomainPointsAreAGoodStart) {
  const double expected[] = {1, 1, 3, 10, 23};
  for (int degree = 0; degree <= 4; ++degree) {
    EXPECT_LE(coefficients_from_values<2>(degree).cwiseAbs().rowwise().sum().maxCoeff(),
              expected[degree] + 1e-12);
  }
}

TEST(Bernstein, UniformBSplinesAreConvexCombinations) {
  for (int degree = 1; degree <= 5; ++degree) {
    const Eigen::MatrixXd& m = bernstein_from_bspline(degree);
    EXPECT_GE(m.minCoeff(), -1e-16);
    EXPECT_LT((m.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-15);
    for (double s : {0.0, 0.3, 0.8, 1.0}) {
      const BSplineSegment functions = bspline_segment(degree, s, 0);
      for (int r = 0; r <= degree; ++r) {
        double sum = 0;
        for (int k = 0; k <= degree; ++k) {
          sum += m(k, r) * factorial(degree) / factorial(k) / factorial(degree - k) *
                 std::pow(s, k) * std::pow(1 - s, degree - k);
        }
        EXPECT_NEAR(sum, functions.value[r], 1e-14);
      }
    }
  }
}

}  // namespace crease
