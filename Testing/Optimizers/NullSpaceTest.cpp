#include "Optimizers/NullSpace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <set>

#include "Core/Error.h"
#include "Optimizers/EliminationNullSpace.h"
#include "Optimizers/SvdNullSpace.h"
#include "Testing/Optimizers/Problems.h"

namespace crease {
namespace {

// N (x) I_k, column by column.
Eigen::MatrixXd stacked_basis(const NullSpace& space) {
  Eigen::MatrixXd N(space.full_size(), space.reduced_size());
  for (Eigen::Index j = 0; j < N.cols(); ++j) {
    N.col(j) = space.apply(Eigen::VectorXd::Unit(space.reduced_size(), j));
  }
  return N;
}

// N itself: the first component's rows and columns.
Eigen::MatrixXd scalar_basis(const NullSpace& space) {
  const Eigen::Index k = space.num_columns();
  const Eigen::MatrixXd N = stacked_basis(space);
  return N(Eigen::seqN(0, space.num_rows(), k), Eigen::seqN(0, space.num_free(), k));
}

std::string kind_name(const ::testing::TestParamInfo<NullSpaceKind>& info) {
  switch (info.param) {
    case NullSpaceKind::kQr:
      return "Qr";
    case NullSpaceKind::kSvd:
      return "Svd";
    default:
      return "Elimination";
  }
}

double max_abs(const Eigen::MatrixXd& M) { return M.size() == 0 ? 0.0 : M.cwiseAbs().maxCoeff(); }

std::set<int> cluster_of(const DependentRow& row) {
  std::set<int> cluster(row.depends_on.begin(), row.depends_on.end());
  cluster.insert(row.row);
  return cluster;
}

// Rows 3, 4 and 9 combine to row 12; row 13 repeats row 0; row 14 is empty.
LinearConstraints planted_dependencies(int columns) {
  LinearConstraints constraints = testing::landmark_constraints(8, 12, columns, 5);
  Eigen::MatrixXd combination = Eigen::MatrixXd::Zero(3, 12);
  combination(0, 3) = 0.5;
  combination(0, 4) = 0.3;
  combination(0, 9) = 0.2;
  combination(1, 0) = 1.0;
  testing::append_dependent_rows(constraints, combination, Eigen::MatrixXd::Zero(3, columns));
  return constraints;
}

}  // namespace

class EveryNullSpace : public ::testing::TestWithParam<NullSpaceKind> {
 protected:
  static std::unique_ptr<NullSpace> make(const LinearConstraints& constraints) {
    return make_null_space(GetParam(), constraints, constraints.C.cols());
  }
};

INSTANTIATE_TEST_SUITE_P(Kinds, EveryNullSpace,
                         ::testing::Values(NullSpaceKind::kElimination, NullSpaceKind::kQr,
                                           NullSpaceKind::kSvd),
                         kind_name);

TEST_P(EveryNullSpace, SatisfiesTheConstraints) {
  for (int count : {1, 12, 40}) {
    const auto constraints = testing::landmark_constraints(12, count, 2, 3);
    const auto space = make(constraints);
    ASSERT_EQ(space->rank(), count);
    const Eigen::MatrixXd N = scalar_basis(*space);
    EXPECT_LE(max_abs(constraints.C * N), 1e-13) << count;
    EXPECT_LE(max_abs(constraints.C * space->offset() - constraints.d), 1e-13) << count;
  }
}

TEST_P(EveryNullSpace, ApplyTransposeIsTheAdjointOfApply) {
  const auto space = make(testing::landmark_constraints(8, 7, 3, 2));
  std::mt19937 random(1);
  const Eigen::VectorXd y = testing::random_vector(space->reduced_size(), random);
  const Eigen::VectorXd g = testing::random_vector(space->full_size(), random);
  EXPECT_NEAR(space->apply(y).dot(g), y.dot(space->apply_transpose(g)), 1e-12);
}

TEST_P(EveryNullSpace, SpanEqualsThatOfTheSvd) {
  const auto constraints = testing::landmark_constraints(9, 12, 1, 4);
  const Eigen::MatrixXd N = scalar_basis(*make(constraints));
  const Eigen::MatrixXd dense = constraints.C;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(dense, Eigen::ComputeFullV);
  const Eigen::MatrixXd V = svd.matrixV().rightCols(81 - 12);
  const Eigen::MatrixXd projector = N * (N.transpose() * N).ldlt().solve(N.transpose());
  EXPECT_LE(max_abs(projector - V * V.transpose()), 1e-10);
}

TEST_P(EveryNullSpace, CoordinatesInvertExpand) {
  const auto space = make(testing::landmark_constraints(8, 9, 2, 6));
  std::mt19937 random(1);
  const Eigen::VectorXd y = testing::random_vector(space->reduced_size(), random);
  EXPECT_LE(max_abs(space->coordinates(space->expand(y)) - y), 1e-12);
}

TEST_P(EveryNullSpace, SolveGramInvertsTheGramMatrix) {
  const auto space = make(testing::landmark_constraints(8, 9, 2, 7));
  const Eigen::MatrixXd N = stacked_basis(*space);
  std::mt19937 random(1);
  const Eigen::VectorXd v = testing::random_vector(space->reduced_size(), random);
  EXPECT_LE(max_abs(N.transpose() * N * space->solve_gram(v) - v), 1e-11);
}

TEST_P(EveryNullSpace, ReducesAHessianAsTheDenseProduct) {
  const auto space = make(testing::landmark_constraints(8, 9, 2, 8));
  const Eigen::MatrixXd N = stacked_basis(*space);
  Eigen::SparseMatrix<double> reduced;
  std::vector<int> pattern;
  for (unsigned seed : {1U, 2U, 3U}) {
    const auto H = testing::grid_hessian(8, 2, 3, seed);
    space->reduce_hessian(H, reduced);
    const Eigen::MatrixXd expected = N.transpose() * testing::dense_symmetric(H) * N;
    EXPECT_LE(max_abs(testing::dense_symmetric(reduced) - expected), 1e-12 * max_abs(expected));
    EXPECT_TRUE(Eigen::MatrixXd(reduced).isLowerTriangular(0.0));
    const std::vector<int> inner(reduced.innerIndexPtr(),
                                 reduced.innerIndexPtr() + reduced.nonZeros());
    if (pattern.empty()) pattern = inner;
    EXPECT_EQ(inner, pattern);
  }
}

TEST_P(EveryNullSpace, ReducesHessiansOfChangingPattern) {
  const auto space = make(testing::landmark_constraints(8, 5, 1, 8));
  const Eigen::MatrixXd N = stacked_basis(*space);
  Eigen::SparseMatrix<double> reduced;
  for (int reach : {3, 1, 2}) {
    const auto H = testing::grid_hessian(8, 1, reach, 1);
    space->reduce_hessian(H, reduced);
    const Eigen::MatrixXd expected = N.transpose() * testing::dense_symmetric(H) * N;
    EXPECT_LE(max_abs(testing::dense_symmetric(reduced) - expected), 1e-12 * max_abs(expected));
  }
}

TEST_P(EveryNullSpace, ReducedHessianAlwaysHasItsDiagonal) {
  const auto space = make(testing::landmark_constraints(6, 3, 2, 8));
  Eigen::SparseMatrix<double> nothing(72, 72);
  Eigen::SparseMatrix<double> reduced;
  space->reduce_hessian(nothing, reduced);
  ASSERT_EQ(reduced.cols(), 66);
  for (int j = 0; j < 66; ++j) EXPECT_EQ(reduced.innerIndexPtr()[reduced.outerIndexPtr()[j]], j);
}

TEST_P(EveryNullSpace, FindsPlantedDependencies) {
  const auto constraints = planted_dependencies(2);
  const auto space = make(constraints);
  EXPECT_EQ(space->rank(), 12);
  ASSERT_EQ(space->dependent_rows().size(), 3U);
  std::set<std::set<int>> clusters;
  for (const auto& row : space->dependent_rows()) {
    clusters.insert(cluster_of(row));
    EXPECT_LE(row.residual.norm(), 1e-12) << row.row;
    Eigen::RowVectorXd left = constraints.C.row(row.row);
    for (std::size_t i = 0; i < row.depends_on.size(); ++i) {
      left -= row.weights[i] * constraints.C.row(row.depends_on[i]);
    }
    EXPECT_LE(max_abs(left), 1e-13) << row.row;
  }
  EXPECT_EQ(clusters, (std::set<std::set<int>>{{3, 4, 9, 12}, {0, 13}, {14}}));
  EXPECT_LE(
      testing::violation(constraints, space->expand(Eigen::VectorXd::Ones(space->reduced_size()))),
      1e-12);
  const auto classes = classify_dependent_rows(*space, 1e-6);
  EXPECT_EQ(classes.redundant.size(), 3U);
  EXPECT_TRUE(classes.contradictory.empty());
}

TEST_P(EveryNullSpace, RankIsExactForManyPlantedDependencies) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    auto constraints = testing::landmark_constraints(10, 20, 1, seed);
    std::mt19937 random(seed);
    const auto count = static_cast<Eigen::Index>(seed % 7);
    testing::append_dependent_rows(constraints, testing::random_matrix(count, 20, random),
                                   Eigen::MatrixXd::Zero(count, 1));
    const auto space = make(constraints);
    EXPECT_EQ(space->rank(), 20) << seed;
    EXPECT_EQ(static_cast<Eigen::Index>(space->dependent_rows().size()), count) << seed;
  }
}

TEST_P(EveryNullSpace, MorePlacesThanControlPointsAreDependent) {
  const auto constraints = testing::landmark_constraints(4, 30, 1, 3);  // 16 control points
  EXPECT_EQ(make(constraints)->rank(), 16);
  EXPECT_EQ(make(constraints)->reduced_size(), 0);
}

TEST_P(EveryNullSpace, ReportsContradictionsWithTheirResidual) {
  auto constraints = testing::landmark_constraints(8, 6, 2, 5);
  Eigen::MatrixXd combination = Eigen::MatrixXd::Zero(1, 6);
  combination(0, 1) = 1.0;
  testing::append_dependent_rows(constraints, combination, Eigen::RowVector2d(3.0, -4.0));
  const auto space = make(constraints);
  const auto classes = classify_dependent_rows(*space, 1e-6);
  EXPECT_TRUE(classes.redundant.empty());
  ASSERT_EQ(classes.contradictory.size(), 1U);
  EXPECT_EQ(cluster_of(classes.contradictory[0]), (std::set<int>{1, 6}));
  EXPECT_NEAR(classes.contradictory[0].residual.norm(), 5.0, 1e-12);
}

TEST_P(EveryNullSpace, WithoutConstraintsIsTheIdentity) {
  const auto space = make_null_space(GetParam(), no_constraints(10, 3), 10);
  EXPECT_EQ(space->rank(), 0);
  EXPECT_EQ(space->reduced_size(), 30);
  std::mt19937 random(1);
  const Eigen::VectorXd y = testing::random_vector(30, random);
  EXPECT_EQ(space->expand(y), y);
  EXPECT_EQ(space->coordinates(y), y);
  EXPECT_EQ(space->apply_transpose(y), y);
  EXPECT_EQ(space->solve_gram(y), y);
}

TEST_P(EveryNullSpace, CoupledConstraintsOnTheStackedVector) {
  // u_x(p) = 2 u_y(p) at 5 landmarks: C with 2 n columns, k = 1.
  const auto landmarks = testing::landmark_constraints(7, 5, 2, 9);
  LinearConstraints coupled;
  std::vector<Eigen::Triplet<double>> entries;
  for (int row = 0; row < 5; ++row) {
    for (decltype(landmarks.C)::InnerIterator entry(landmarks.C, row); entry; ++entry) {
      const auto point = static_cast<int>(entry.col());
      entries.emplace_back(row, 2 * point, entry.value());
      entries.emplace_back(row, 2 * point + 1, -2.0 * entry.value());
    }
  }
  coupled.C.resize(5, 2 * 49);
  coupled.C.setFromTriplets(entries.begin(), entries.end());
  coupled.d = RowMatrix::Zero(5, 1);
  const auto space = make(coupled);
  EXPECT_EQ(space->reduced_size(), 2 * 49 - 5);
  std::mt19937 random(1);
  const Eigen::VectorXd x = space->expand(testing::random_vector(space->reduced_size(), random));
  const Eigen::Map<const RowMatrix> phi(x.data(), 49, 2);
  const Eigen::MatrixXd u = landmarks.C * phi;
  EXPECT_LE(max_abs(u.col(0) - 2.0 * u.col(1)), 1e-13);
  EXPECT_GT(max_abs(u), 0.1);
}

TEST_P(EveryNullSpace, RefusesAHessianOfAnotherSize) {
  const auto space = make(testing::landmark_constraints(6, 3, 2, 1));
  Eigen::SparseMatrix<double> reduced;
  EXPECT_THAT([&] { space->reduce_hessian(testing::grid_hessian(6, 1, 1, 1), reduced); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("72 x 72")));
}

TEST_P(EveryNullSpace, RefusesVectorsOfAnotherSize) {
  const auto space = make(testing::landmark_constraints(6, 3, 2, 1));
  const Eigen::VectorXd x = Eigen::VectorXd::Zero(71);
  EXPECT_THROW(space->apply(x), InvalidInput);
  EXPECT_THROW(space->expand(x), InvalidInput);
  EXPECT_THROW(space->apply_transpose(x), InvalidInput);
  EXPECT_THROW(space->solve_gram(x), InvalidInput);
  EXPECT_THROW(space->coordinates(x), InvalidInput);
}

TEST_P(EveryNullSpace, ChecksItsConstraints) {
  const auto constraints = testing::landmark_constraints(6, 3, 2, 1);
  EXPECT_THROW(make_null_space(GetParam(), constraints, 35), InvalidInput);
}

TEST(EliminationNullSpace, IsSparseAndWellConditioned) {
  const EliminationNullSpace space(testing::landmark_constraints(25, 12, 2, 3), 625);
  const double per_column =
      static_cast<double>(space.basis().nonZeros()) / static_cast<double>(space.basis().cols());
  EXPECT_LE(per_column, 2.0);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd{Eigen::MatrixXd(space.basis())};
  EXPECT_LE(svd.singularValues()[0] / svd.singularValues().tail(1)[0], 10.0);
}

TEST(EliminationNullSpace, CoordinatesAreTheFreeRows) {
  const EliminationNullSpace space(testing::landmark_constraints(6, 3, 2, 1), 36);
  std::mt19937 random(1);
  const Eigen::VectorXd phi = testing::random_vector(72, random);
  const Eigen::VectorXd y = space.coordinates(phi);
  for (std::size_t f = 0; f < space.free_rows().size(); ++f) {
    EXPECT_EQ(y.segment<2>(2 * static_cast<Eigen::Index>(f)),
              phi.segment<2>(2 * space.free_rows()[f]));
  }
}

TEST(SvdNullSpace, KnowsTheConditionOfTheConstraints) {
  auto constraints = planted_dependencies(1);
  const SvdNullSpace space(constraints, constraints.C.cols());
  const auto& s = space.singular_values();
  ASSERT_EQ(s.size(), 15);
  EXPECT_GT(s[11], 1e-4);
  EXPECT_LT(s[12], 1e-12);
}
}  // namespace crease
