#include "Optimizers/QuadraticMinimum.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "Core/Error.h"
#include "Testing/Optimizers/Problems.h"

namespace crease {
namespace {

// Of the stacked problem, with Lagrange multipliers, dense.
Eigen::VectorXd lagrange_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                  const Eigen::MatrixXd& C, const Eigen::VectorXd& d) {
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(A.rows() + C.rows(), A.rows() + C.rows());
  system.topLeftCorner(A.rows(), A.cols()) = A;
  system.bottomLeftCorner(C.rows(), C.cols()) = C;
  system.topRightCorner(C.cols(), C.rows()) = C.transpose();
  Eigen::VectorXd rhs(system.rows());
  rhs << b, d;
  return system.fullPivLu().solve(rhs).head(A.rows());
}

Eigen::MatrixXd times_identity(const Eigen::MatrixXd& M, Eigen::Index k) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(k * M.rows(), k * M.cols());
  for (Eigen::Index a = 0; a < k; ++a) {
    result(Eigen::seqN(a, M.rows(), k), Eigen::seqN(a, M.cols(), k)) = M;
  }
  return result;
}

}  // namespace

TEST(QuadraticMinimum, EqualsTheSolutionWithLagrangeMultipliers) {
  const auto constraints = testing::landmark_constraints(7, 6, 2, 3);
  std::mt19937 random(1);
  const Eigen::VectorXd b = testing::random_vector(98, random);
  const Eigen::MatrixXd C = times_identity(constraints.C, 2);
  const Eigen::VectorXd d = Eigen::Map<const Eigen::VectorXd>(constraints.d.data(), 12);
  const auto scalar = testing::grid_hessian(7, 1, 3, 1);
  const auto stacked = testing::grid_hessian(7, 2, 3, 2);
  for (auto kind : {NullSpaceKind::kElimination, NullSpaceKind::kQr, NullSpaceKind::kSvd}) {
    const auto space = make_null_space(kind, constraints, 49);
    const Eigen::VectorXd x = minimize_quadratic(stacked, b, *space);
    EXPECT_LE((x - lagrange_solution(testing::dense_symmetric(stacked), b, C, d)).norm(), 1e-9);
    const Eigen::VectorXd y = minimize_quadratic(scalar, b, *space);
    const Eigen::MatrixXd A = times_identity(testing::dense_symmetric(scalar), 2);
    EXPECT_LE((y - lagrange_solution(A, b, C, d)).norm(), 1e-9);
    EXPECT_LE(testing::violation(constraints, y), 1e-12);
  }
}

TEST(QuadraticMinimum, NothingIsFree) {
  const auto constraints = testing::landmark_constraints(4, 16, 1, 3);
  const auto space = make_null_space(NullSpaceKind::kElimination, constraints, 16);
  const Eigen::VectorXd x =
      minimize_quadratic(testing::grid_hessian(4, 1, 1, 1), Eigen::VectorXd::Ones(16), *space);
  EXPECT_EQ(x, space->expand(Eigen::VectorXd()));
}

TEST(QuadraticMinimum, SaysThatTheMatrixIsNotPositiveDefinite) {
  const auto space = make_null_space(NullSpaceKind::kElimination, no_constraints(9, 2), 9);
  Eigen::SparseMatrix<double> zero(9, 9);
  EXPECT_THAT([&] { minimize_quadratic(zero, Eigen::VectorXd::Ones(18), *space); },
              ::testing::ThrowsMessage<SolverError>(::testing::HasSubstr("not positive definite")));
}

TEST(QuadraticMinimum, RefusesSizesThatDiffer) {
  const auto space = make_null_space(NullSpaceKind::kElimination, no_constraints(9, 2), 9);
  const auto A = testing::grid_hessian(3, 1, 1, 1);
  EXPECT_THROW(minimize_quadratic(A, Eigen::VectorXd::Ones(9), *space), InvalidInput);
  EXPECT_THROW(
      minimize_quadratic(testing::grid_hessian(4, 1, 1, 1), Eigen::VectorXd::Ones(18), *space),
      InvalidInput);
}
}  // namespace crease
