// What L-BFGS and nonlinear conjugate gradients promise beyond what every optimizer does (OptimizerTest).
#include "Optimizers/LineSearch.h"

#include <gtest/gtest.h>

#include "Optimizers/GaussNewton.h"
#include "Optimizers/Lbfgs.h"
#include "Optimizers/NonlinearConjugateGradient.h"
#include "Testing/Optimizers/GslMinimum.h"
#include "Testing/Optimizers/Problems.h"

namespace crease {
namespace {

const OptimizerOptions kStrict{
    .relative_decrease = 0.0, .relative_gradient = 1e-8, .max_iterations = 3000};

std::vector<std::unique_ptr<Optimizer>> methods(const OptimizerOptions& stopping,
                                                bool precondition) {
  std::vector<std::unique_ptr<Optimizer>> all;
  all.push_back(std::make_unique<Lbfgs>(stopping, LbfgsOptions{.precondition = precondition}));
  all.push_back(std::make_unique<NonlinearConjugateGradient>(
      stopping, NonlinearConjugateGradientOptions{.precondition = precondition}));
  return all;
}

/// Bending and a foundation on a grid of side x side points of the unit square: 1/2 |Laplace u|^2 + 1/2 |u|^2,
/// so that the condition grows by 16 when the grid is halved.
Eigen::SparseMatrix<double> plate(int side) {
  const int size = side * side;
  const double h = 1.0 / side;
  std::vector<Eigen::Triplet<double>> entries;
  for (int p = 0; p < size; ++p) {
    const int i = p % side, j = p / side;
    const auto couple = [&](int q) {
      entries.emplace_back(p, p, 1e-2 / (h * h));
      entries.emplace_back(p, q, -1e-2 / (h * h));
    };
    if (i > 0) couple(p - 1);
    if (i + 1 < side) couple(p + 1);
    if (j > 0) couple(p - side);
    if (j + 1 < side) couple(p + side);
  }
  Eigen::SparseMatrix<double> laplace(size, size);
  laplace.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseMatrix<double> identity(size, size);
  identity.setIdentity();
  const Eigen::SparseMatrix<double> A = h * h * (laplace.transpose() * laplace + identity);
  return A.triangularView<Eigen::Lower>();
}

}  // namespace

TEST(LineSearch, AgreesWithGslInEveryNullSpaceAndIsSilent) {
  ::testing::internal::CaptureStderr();  // Ceres warns of restarts, which happen here
  const auto constraints = testing::landmark_constraints(7, 8, 2, 3);
  std::mt19937 random(11);
  testing::ConvexFunction convex(testing::grid_hessian(7, 2, 3, 2),
                                 10.0 * testing::random_vector(98, random), 40.0);
  testing::PreconditionedFunction function(convex, testing::grid_hessian(7, 1, 3, 5));
  const Eigen::VectorXd start = Eigen::VectorXd::Zero(98);
  for (auto kind : {NullSpaceKind::kElimination, NullSpaceKind::kQr, NullSpaceKind::kSvd}) {
    const auto space = make_null_space(kind, constraints, 49);
    const auto gsl = testing::gsl_minimum(testing::GslMethod::kBfgs, function, *space, start);
    const auto other =
        testing::gsl_minimum(testing::GslMethod::kPolakRibiere, function, *space, start);
    EXPECT_NEAR(other.value, gsl.value, 1e-9 * std::abs(gsl.value));
    for (bool precondition : {false, true}) {
      for (const auto& method : methods(kStrict, precondition)) {
        const auto result = method->minimize(function, start, space.get());
        EXPECT_NEAR(result.value, gsl.value, 1e-9 * std::abs(gsl.value));
        EXPECT_LE((result.x - gsl.x).norm(), 1e-5 * gsl.x.norm());
        EXPECT_LE(testing::violation(constraints, result.x), 1e-12);
      }
    }
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(LineSearch, NeedsNoMoreIterationsOnFinerMeshesWithAPreconditioner) {
  for (std::size_t m = 0; m < 2; ++m) {
    std::vector<int> plain, preconditioned;
    for (int side : {8, 16, 32}) {
      const double h2 = 1.0 / (side * side);
      Eigen::VectorXd b(side * side);
      for (int p = 0; p < b.size(); ++p) {
        const int row = p / side, column = p % side;
        const double x = (column + 0.5) / side, y = (row + 0.5) / side;
        b[p] = h2 * 10 * std::sin(7 * x + 3 * y * y);
      }
      testing::ConvexFunction convex(plate(side), b, h2);
      testing::PreconditionedFunction function(convex, plate(side));
      const OptimizerOptions stopping{
          .relative_decrease = 0.0, .relative_gradient = 1e-4, .max_iterations = 3000};
      const Eigen::VectorXd start = Eigen::VectorXd::Zero(side * side);
      plain.push_back(methods(stopping, false)[m]->minimize(function, start).iterations);
      preconditioned.push_back(methods(stopping, true)[m]->minimize(function, start).iterations);
    }
    EXPECT_GT(plain[2], 3 * plain[0]);
    EXPECT_LE(preconditioned[2], preconditioned[0] + 2);
    EXPECT_LE(preconditioned[2], 12);
  }
}

TEST(LineSearch, FirstTrialIsNewtonsStepOfThePreconditioner) {
  std::mt19937 random(1);
  const auto A = testing::grid_hessian(6, 2, 3, 2);
  for (double scale : {1e-3, 1.0, 1e3}) {
    const Eigen::SparseMatrix<double> scaled = scale * A;
    testing::ConvexFunction quadratic(scaled, testing::random_vector(72, random), 0.0);
    testing::PreconditionedFunction function(quadratic, scaled);
    for (const auto& method : methods({.relative_gradient = 1e-9}, true)) {
      quadratic.evaluations = 0;
      const auto result = method->minimize(function, Eigen::VectorXd::Zero(72));
      EXPECT_EQ(result.iterations, 1);
      EXPECT_EQ(quadratic.evaluations, 2);
    }
  }
}

TEST(LineSearch, FollowsRosenbrocksValley) {
  for (const auto& method : methods(kStrict, true)) {
    testing::Rosenbrock function;
    const auto result = method->minimize(function, Eigen::Vector2d(-1.2, 1.0));
    EXPECT_LE((result.x - Eigen::Vector2d(1, 1)).norm(), 1e-5);
    EXPECT_LE(result.num_evaluations, 300);
  }
}

TEST(LineSearch, StopsWhereNoStepLowersTheValue) {
  testing::ConvexFunction function(testing::grid_hessian(6, 1, 2, 2), Eigen::VectorXd::Ones(36),
                                   1.0);
  for (const auto& method : methods(
           {.relative_decrease = 0.0, .relative_gradient = 0.0, .max_iterations = 3000}, true)) {
    const auto result = method->minimize(function, Eigen::VectorXd::Constant(36, 5.0));
    EXPECT_EQ(result.reason, StopReason::kNoDecrease);
    EXPECT_LE(result.history.back().gradient_norm, 1e-6 * result.history.front().gradient_norm);
  }
}

}  // namespace crease
