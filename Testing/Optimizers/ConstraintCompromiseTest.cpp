#include "Optimizers/ConstraintCompromise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>

#include "Optimizers/NullSpace.h"
#include "Testing/Optimizers/Problems.h"

namespace crease {
namespace {

/// Constraints of eight landmarks, the last two of which contradict others.
LinearConstraints contradicting_constraints() {
  auto constraints = testing::landmark_constraints(8, 6, 2, 5);
  Eigen::MatrixXd combination = Eigen::MatrixXd::Zero(2, 6);
  combination(0, 1) = 1.0;
  combination(1, 2) = 0.4;
  combination(1, 3) = 0.6;
  Eigen::MatrixXd shift(2, 2);
  shift << 3.0, -4.0, 1.0, 2.0;
  testing::append_dependent_rows(constraints, combination, shift);
  return constraints;
}

constexpr std::array kAll = {0, 1, 2, 3, 4, 5, 6, 7};

}  // namespace

TEST(ConstraintCompromise, AllDirectionsGiveTheLeastSquaresSolution) {
  const auto constraints = contradicting_constraints();
  const auto agreed = compromise(constraints, kAll, 0);
  EXPECT_EQ(agreed.num_rows(), 6);
  const auto space = make_null_space(NullSpaceKind::kElimination, agreed, constraints.C.cols());
  EXPECT_EQ(space->rank(), 6);
  const Eigen::MatrixXd C = constraints.C;
  const Eigen::MatrixXd best =
      C * C.completeOrthogonalDecomposition().solve(Eigen::MatrixXd(constraints.d));
  EXPECT_LT((C * space->offset() - best).cwiseAbs().maxCoeff(), 1e-12);
  // The repeated landmark is met half way.
  EXPECT_NEAR((C * space->offset() - constraints.d).row(1).norm(), 2.5, 1e-12);
}

TEST(ConstraintCompromise, OtherRowsStayAsTheyAre) {
  const auto constraints = contradicting_constraints();
  const auto agreed = compromise(constraints, std::array{1, 6}, 0);
  ASSERT_EQ(agreed.num_rows(), 7);
  EXPECT_THAT(agreed.names,
              ::testing::ElementsAre(constraints.name(0), constraints.name(2), constraints.name(3),
                                     constraints.name(4), constraints.name(5), constraints.name(7),
                                     "compromise 1"));
  const Eigen::MatrixXd C = constraints.C, kept = agreed.C;
  EXPECT_EQ(kept.row(0), C.row(0));
  EXPECT_EQ(kept.row(5), C.row(7));
  EXPECT_EQ(agreed.d.row(3), constraints.d.row(4));
  // Both of the replaced rows are the same: what is left is their mean.
  EXPECT_NEAR(std::abs(kept.row(6).dot(C.row(1))), C.row(1).norm(), 1e-12);
}

// Two rows that differ by a thousandth and ask for values 1 apart: met one by one they need Phi = 1000.
TEST(ConstraintCompromise, NearlyEqualRowsAreMetByTheirMean) {
  LinearConstraints constraints;
  constraints.C.resize(2, 3);
  constraints.C.insert(0, 0) = 1;
  constraints.C.insert(0, 1) = 1e-3;
  constraints.C.insert(1, 0) = 1;
  constraints.C.insert(1, 1) = -1e-3;
  constraints.d.resize(2, 1);
  constraints.d << 2, 3;
  const auto largest = [&](double share) {
    const auto agreed = compromise(constraints, std::array{0, 1}, share);
    const Eigen::MatrixXd C = agreed.C;
    return C.completeOrthogonalDecomposition()
        .solve(Eigen::MatrixXd(agreed.d))
        .cwiseAbs()
        .maxCoeff();
  };
  EXPECT_NEAR(largest(0), 500, 1e-9);
  EXPECT_NEAR(largest(0.5), 2.5, 1e-9);
}

}  // namespace crease
