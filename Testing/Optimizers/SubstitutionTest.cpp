#include "Optimizers/Substitution.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "Core/Error.h"
#include "Testing/Optimizers/Problems.h"

namespace crease {
namespace {

constexpr int kSide = 6;
constexpr int kPoints = kSide * kSide;

testing::ConvexFunction plain_function() {
  return {testing::grid_hessian(kSide, 2, 3, 2), Eigen::VectorXd::Ones(2 * kPoints), 1.0};
}

/// N (x) I_k, column by column.
Eigen::MatrixXd dense_null_space(const NullSpace& space) {
  Eigen::MatrixXd N(space.full_size(), space.reduced_size());
  for (Eigen::Index j = 0; j < N.cols(); ++j) {
    N.col(j) = space.apply(Eigen::VectorXd::Unit(N.cols(), j));
  }
  return N;
}

/// P as it acts on stacked control points.
Eigen::MatrixXd stacked(const Eigen::SparseMatrix<double>& P) {
  const Eigen::MatrixXd dense = testing::dense_symmetric(P);
  const Eigen::Index k = 2 * kPoints / dense.rows();
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(2 * kPoints, 2 * kPoints);
  for (Eigen::Index i = 0; i < dense.rows(); ++i) {
    for (Eigen::Index j = 0; j < dense.cols(); ++j) {
      for (Eigen::Index a = 0; a < k; ++a) full(k * i + a, k * j + a) = dense(i, j);
    }
  }
  return full;
}

void expect_inverse(const Substitution& substitution, const Eigen::MatrixXd& A) {
  std::mt19937 random(3);
  const Eigen::VectorXd g = testing::random_vector(A.rows(), random);
  const Eigen::VectorXd step = substitution.step(substitution.gradient(g));
  EXPECT_LE((A * step - g).norm(), 1e-9 * g.norm());
}

/// Constraints on columns, or on stacked coordinates.
LinearConstraints constraints_on(int columns) {
  auto constraints = testing::landmark_constraints(kSide, 5, 2, 3);
  if (columns == 2) return constraints;
  LinearConstraints coupled;
  coupled.C.resize(1, 2 * kPoints);
  coupled.C.insert(0, 7) = 1.0;
  coupled.C.insert(0, 20) = -2.0;
  coupled.d = RowMatrix::Ones(1, 1);
  return coupled;
}

}  // namespace

// Steepest descent in Z is Newton's step for the preconditioner, in every null space.
TEST(Substitution, SolvesWithScalarAndFullPreconditioners) {
  auto plain = plain_function();
  const Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * kPoints);
  for (const auto& P :
       {testing::grid_hessian(kSide, 1, 2, 5), testing::grid_hessian(kSide, 2, 2, 5)}) {
    testing::PreconditionedFunction function(plain, P);
    for (int columns : {1, 2}) {
      for (auto kind : {NullSpaceKind::kElimination, NullSpaceKind::kQr, NullSpaceKind::kSvd}) {
        const auto space =
            make_null_space(kind, constraints_on(columns), columns == 2 ? kPoints : 2 * kPoints);
        const Substitution substitution(function, x, *space, true);
        EXPECT_TRUE(substitution.preconditioned());
        const Eigen::MatrixXd N = dense_null_space(*space);
        expect_inverse(substitution, N.transpose() * stacked(P) * N);
      }
    }
  }
}

TEST(Substitution, MeasuresStepsInPhiWithoutAPreconditioner) {
  auto plain = plain_function();
  testing::PreconditionedFunction offering(plain, testing::grid_hessian(kSide, 1, 2, 5));
  const Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * kPoints);
  const auto space = make_null_space(NullSpaceKind::kElimination, constraints_on(2), kPoints);
  const Eigen::MatrixXd N = dense_null_space(*space);
  for (const Substitution& substitution :
       {Substitution(plain, x, *space, true), Substitution(offering, x, *space, false)}) {
    EXPECT_FALSE(substitution.preconditioned());
    expect_inverse(substitution, N.transpose() * N);
  }
}

// Directions of no stiffness get a little: steps stay finite.
TEST(Substitution, HoldsWhatASemiDefinitePreconditionerDoesNotSee) {
  auto plain = plain_function();
  Eigen::SparseMatrix<double> P(kPoints, kPoints);
  for (int i = 0; i < kPoints - 4; ++i) P.insert(i, i) = 2.0;
  P.makeCompressed();
  testing::PreconditionedFunction function(plain, P);
  const auto space =
      make_null_space(NullSpaceKind::kElimination, no_constraints(kPoints, 2), kPoints);
  const Substitution substitution(function, Eigen::VectorXd::Zero(2 * kPoints), *space, true);
  const Eigen::VectorXd step =
      substitution.step(substitution.gradient(Eigen::VectorXd::Ones(2 * kPoints)));
  EXPECT_NEAR(step[0], 0.5, 1e-6);
  EXPECT_TRUE(step.allFinite());
}

TEST(Substitution, RefusesWhatIsNoPreconditioner) {
  auto plain = plain_function();
  const Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * kPoints);
  const auto space =
      make_null_space(NullSpaceKind::kElimination, no_constraints(kPoints, 2), kPoints);
  auto P = testing::grid_hessian(kSide, 1, 2, 5);
  P.coeffRef(3, 3) = std::nan("");
  testing::PreconditionedFunction broken(plain, P);
  EXPECT_THROW(Substitution(broken, x, *space, true), SolverError);
  testing::PreconditionedFunction odd(plain, testing::grid_hessian(5, 1, 2, 5));
  EXPECT_THAT([&] { Substitution(odd, x, *space, true); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("25 rows")));
}

}  // namespace crease
