#include "Optimizers/SparseCholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstring>
#include <limits>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Testing/Optimizers/Problems.h"

namespace crease {

TEST(SparseCholesky, SolvesSmallAndLargeSystems) {
  std::mt19937 random(1);
  for (int side : {2, 6, 20}) {
    const auto A = testing::grid_hessian(side, 2, 3, 1);
    const Eigen::VectorXd x = testing::random_vector(A.cols(), random);
    SparseCholesky cholesky;
    ASSERT_TRUE(cholesky.factor(A));
    const Eigen::VectorXd b = A.selfadjointView<Eigen::Lower>() * x;
    EXPECT_LE((cholesky.solve(b) - x).norm(), 1e-12 * x.norm()) << side;
  }
}

TEST(SparseCholesky, ChoosesTheMethodBySize) {
  SparseCholesky cholesky;
  ASSERT_TRUE(cholesky.factor(testing::grid_hessian(25, 2, 3, 1)));
  EXPECT_TRUE(cholesky.is_supernodal());
  Eigen::SparseMatrix<double> identity(50, 50);
  identity.setIdentity();
  ASSERT_TRUE(cholesky.factor(identity));
  EXPECT_FALSE(cholesky.is_supernodal());
  EXPECT_EQ(cholesky.num_nonzeros(), 50U);
}

TEST(SparseCholesky, FactorsNewNumbersAndNewPatterns) {
  std::mt19937 random(1);
  SparseCholesky cholesky;
  for (const auto& A : {testing::grid_hessian(9, 2, 3, 1), testing::grid_hessian(9, 2, 3, 2),
                        testing::grid_hessian(9, 2, 1, 3), testing::grid_hessian(5, 1, 1, 4)}) {
    ASSERT_TRUE(cholesky.factor(A));
    const Eigen::MatrixXd X = testing::random_matrix(A.cols(), 3, random);
    const Eigen::MatrixXd B = testing::dense_symmetric(A) * X;
    EXPECT_LE((cholesky.solve_columns(B) - X).norm(), 1e-12 * X.norm());
  }
}

TEST(SparseCholesky, ItsRootMakesTheMatrixTheIdentity) {
  for (int side : {1, 5, 25}) {  // simplicial and supernodal
    const auto A = testing::grid_hessian(side, 2, 3, 1);
    SparseCholesky cholesky;
    ASSERT_TRUE(cholesky.factor(A));
    const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(A.rows(), A.rows());
    const Eigen::MatrixXd R = cholesky.solve_root(identity);  // R^-1
    const Eigen::MatrixXd product = R.transpose() * testing::dense_symmetric(A) * R;
    EXPECT_LE((product - identity).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LE((cholesky.solve_root_transpose(identity) - R.transpose()).cwiseAbs().maxCoeff(),
              1e-13);
  }
}

TEST(SparseCholesky, IgnoresTheUpperTriangle) {
  auto A = testing::grid_hessian(5, 1, 1, 1);
  const Eigen::VectorXd b = Eigen::VectorXd::Ones(25);
  SparseCholesky cholesky;
  ASSERT_TRUE(cholesky.factor(A));
  const Eigen::VectorXd x = cholesky.solve(b);
  A.coeffRef(0, 24) = 1000.0;
  A.makeCompressed();
  ASSERT_TRUE(cholesky.factor(A));
  EXPECT_LE((cholesky.solve(b) - x).norm(), 1e-14);
}

TEST(SparseCholesky, NoticesMatricesThatAreNotPositiveDefinite) {
  for (int side : {4, 20}) {  // simplicial and supernodal
    auto A = testing::grid_hessian(side, 2, 3, 1);
    SparseCholesky cholesky;
    ASSERT_TRUE(cholesky.factor(A));
    const double diagonal = A.coeff(9, 9);
    for (double bad : {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
      A.coeffRef(9, 9) = bad;
      EXPECT_FALSE(cholesky.factor(A)) << side << ", " << bad;
      EXPECT_FALSE(cholesky.has_factor());
    }
    A.coeffRef(9, 9) = diagonal;
    EXPECT_TRUE(cholesky.factor(A));
  }
}

TEST(SparseCholesky, SameBytesOnAnyNumberOfThreads) {
  const auto A = testing::grid_hessian(30, 2, 3, 1);
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(A.cols(), -1.0, 1.0);
  Eigen::VectorXd reference;
  for (int threads : {1, 2, 8}) {
    set_num_threads(threads);
    std::vector<Eigen::VectorXd> solutions(4);  // several at once, as in a parallel program
    parallel_for(4, [&](std::int64_t i) {
      SparseCholesky cholesky;
      ASSERT_TRUE(cholesky.factor(A));
      solutions[static_cast<std::size_t>(i)] = cholesky.solve(b);
    });
    if (reference.size() == 0) reference = solutions[0];
    for (const auto& x : solutions) {
      EXPECT_EQ(std::memcmp(x.data(), reference.data(), sizeof(double) * x.size()), 0) << threads;
    }
  }
  set_num_threads(0);
}

TEST(SparseCholesky, RefusesBadInput) {
  SparseCholesky cholesky;
  EXPECT_THROW(cholesky.factor(Eigen::SparseMatrix<double>(3, 4)), InvalidInput);
  EXPECT_THROW(cholesky.solve(Eigen::VectorXd::Ones(3)), InvalidInput);
  ASSERT_TRUE(cholesky.factor(testing::grid_hessian(3, 1, 1, 1)));
  EXPECT_THROW(cholesky.solve(Eigen::VectorXd::Ones(8)), InvalidInput);
}
}  // namespace crease
