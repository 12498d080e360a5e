#include <gtest/gtest.h>

#include <random>

#include "Testing/Transforms/Splines/TestNets.h"
#include "Transforms/Splines/Continuation.h"
#include "Transforms/Splines/SplineSampler.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {
namespace {

Eigen::MatrixXd random_points(int rows, int columns) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Eigen::MatrixXd points(rows, columns);
  for (double& v : points.reshaped()) v = uniform(random);
  return points;
}

/// A row of points across the domain and beyond it, and some at random.
std::vector<Point<2>> places(int count) {
  std::vector<Point<2>> points;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(-30, 70);
  for (int i = 0; i < count; ++i)
    points.emplace_back(-20 + 80.0 * i / count, 11.3 + 9.0 * i / count);
  for (int i = 0; i < count; ++i) points.emplace_back(uniform(random), uniform(random));
  return points;
}

/// What SplineSampler promises, function by function.
Eigen::VectorXd jet_at(const TriangularBSplineBasis<2>& basis, const Eigen::MatrixXd& phi,
                       const Point<2>& x) {
  const Point<2> p = basis.nearest_point(x);
  const auto here = basis.evaluate(p, 1);
  Eigen::MatrixXd jet = Eigen::MatrixXd::Zero(phi.rows(), 3);
  for (std::size_t n = 0; n < here.control_points.size(); ++n) {
    const auto column = phi.col(here.control_points[n]);
    jet.col(0) += here.values[n] * column;
    jet.rightCols<2>() += column * here.gradients.col(n).transpose();
  }
  const Continuation<2> on(x - p, basis.mean_edge_length());
  jet.col(0) += jet.rightCols<2>() * on.step;
  jet.rightCols<2>() = (jet.rightCols<2>() * on.stretch).eval();
  return jet.reshaped();
}

TEST(TriangularBSplineSampler, AgreesWithTheFunctionsOneByOne) {
  const auto x = places(400);
  for (const auto& net : testing::nets_of_all_degrees()) {
    const TriangularBSplineBasis<2> basis(net);
    for (const int rows : {2, 3}) {
      const Eigen::MatrixXd phi = random_points(rows, basis.num_control_points());
      const auto sampler = basis.sampler(phi);
      Eigen::MatrixXd jets(3 * rows, std::ssize(x));
      std::vector<std::uint8_t> inside(x.size());
      sampler->sample(x, jets, inside);
      int num_inside = 0;
      for (std::size_t k = 0; k < x.size(); ++k) {
        ASSERT_EQ(inside[k] != 0, basis.contains(x[k]));
        num_inside += inside[k];
        const Eigen::VectorXd expected = jet_at(basis, phi, x[k]);
        const double error = (jets.col(static_cast<Eigen::Index>(k)) - expected).norm();
        EXPECT_LT(error, 1e-9 * (1 + expected.norm()))
            << "degree " << net.degree << ", point " << x[k].transpose();
      }
      EXPECT_GT(num_inside, 100);
      EXPECT_LT(num_inside, 700);
    }
  }
}

}  // namespace
}  // namespace crease
