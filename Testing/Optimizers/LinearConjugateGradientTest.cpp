#include "Optimizers/LinearConjugateGradient.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "Optimizers/SparseCholesky.h"
#include "Testing/Optimizers/Problems.h"

namespace crease {
namespace {
const auto kNoPreconditioner = [](const Eigen::VectorXd& r) { return r; };
}

TEST(LinearConjugateGradient, IsExactAfterAsManyStepsAsDistinctEigenvalues) {
  const Eigen::VectorXd diagonal = (Eigen::VectorXd(6) << 1, 1, 4, 4, 9, 9).finished();
  const auto apply = [&](const Eigen::VectorXd& p) -> Eigen::VectorXd {
    return diagonal.cwiseProduct(p);
  };
  const auto result = linear_conjugate_gradient(apply, kNoPreconditioner, Eigen::VectorXd::Ones(6),
                                                {.tolerance = 1e-12, .max_iterations = 10});
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.iterations, 3);
  EXPECT_LE((result.x - diagonal.cwiseInverse()).norm(), 1e-12);
}

TEST(LinearConjugateGradient, ExactPreconditionerNeedsOneStep) {
  const auto A = testing::grid_hessian(8, 2, 2, 1);
  SparseCholesky cholesky;
  ASSERT_TRUE(cholesky.factor(A));
  const auto apply = [&](const Eigen::VectorXd& p) -> Eigen::VectorXd {
    return A.selfadjointView<Eigen::Lower>() * p;
  };
  const auto result =
      linear_conjugate_gradient(apply, [&](const Eigen::VectorXd& r) { return cholesky.solve(r); },
                                Eigen::VectorXd::Ones(A.cols()), {.tolerance = 1e-10});
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.iterations, 1);
}

TEST(LinearConjugateGradient, StopsAtItsLimitWithADescentDirection) {
  const auto A = testing::grid_hessian(8, 2, 2, 1);
  const auto apply = [&](const Eigen::VectorXd& p) -> Eigen::VectorXd {
    return A.selfadjointView<Eigen::Lower>() * p;
  };
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(A.cols(), -1, 2);
  double previous = 0.0;
  for (int limit : {1, 2, 3}) {
    const auto result = linear_conjugate_gradient(apply, kNoPreconditioner, b,
                                                  {.tolerance = 1e-14, .max_iterations = limit});
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(result.iterations, limit);
    const double energy = 0.5 * result.x.dot(apply(result.x)) - b.dot(result.x);
    EXPECT_LT(energy, previous);
    previous = energy;
  }
}

TEST(LinearConjugateGradient, ReportsAnIndefiniteMatrix) {
  const auto apply = [](const Eigen::VectorXd& p) -> Eigen::VectorXd { return -p; };
  const auto result = linear_conjugate_gradient(apply, kNoPreconditioner, Eigen::VectorXd::Ones(3));
  EXPECT_TRUE(result.breakdown);
  EXPECT_FALSE(result.converged);
}

TEST(LinearConjugateGradient, ZeroRightHandSideHasTheZeroSolution) {
  const auto result =
      linear_conjugate_gradient(kNoPreconditioner, kNoPreconditioner, Eigen::VectorXd::Zero(3));
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_TRUE(result.x.isZero(0.0));
}
}  // namespace crease
