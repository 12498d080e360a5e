#include "Transforms/BlockHessian.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "Core/Error.h"

namespace crease {
namespace {

std::shared_ptr<const HessianPattern> small_pattern() {
  return std::make_shared<HessianPattern>(
      4, std::vector<std::pair<int, int>>{{0, 2}, {2, 0}, {3, 1}, {1, 1}, {2, 3}});
}

// The same sums in a dense matrix, entry by entry.
template <int Dim>
void check_against_dense() {
  BlockHessian<Dim> hessian(small_pattern());
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(4 * Dim, 4 * Dim);
  std::srand(3);
  for (const auto& [i, k] :
       std::vector<std::pair<int, int>>{{0, 2}, {2, 0}, {1, 3}, {3, 1}, {2, 2}, {0, 0}, {2, 3}}) {
    Matrix<Dim> block = Matrix<Dim>::Random();
    if (i == k) block = (block + block.transpose()).eval();
    hessian.add(i, k, block);
    dense.block(Dim * i, Dim * k, Dim, Dim) += block;
    if (i != k) dense.block(Dim * k, Dim * i, Dim, Dim) += block.transpose();
  }
  const auto sparse = hessian.to_sparse();
  EXPECT_TRUE(
      Eigen::MatrixXd(sparse).isApprox(Eigen::MatrixXd(dense.triangularView<Eigen::Lower>())));
  for (int c = 0; c < sparse.cols(); ++c) {
    int last = -1;
    for (Eigen::SparseMatrix<double>::InnerIterator it(sparse, c); it; ++it) {
      EXPECT_GT(it.row(), last);
      last = static_cast<int>(it.row());
    }
  }
}

}  // namespace

TEST(HessianPattern, HoldsEachPairOnceWithTheDiagonal) {
  const auto pattern = small_pattern();
  EXPECT_EQ(pattern->num_entries(), 7);
  EXPECT_THAT(pattern->columns(), ::testing::ElementsAre(0, 1, 0, 2, 1, 2, 3));
  EXPECT_EQ(pattern->slot(1, 3), pattern->slot(3, 1));
}

TEST(HessianPattern, NamesThePairThatIsMissing) {
  EXPECT_THAT([] { (void)small_pattern()->slot(0, 3); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("points 0 and 3")));
  EXPECT_THROW(HessianPattern(2, {{0, 2}}), InvalidInput);
}

TEST(BlockHessian, MatchesADenseMatrix) {
  check_against_dense<2>();
  check_against_dense<3>();
}

TEST(BlockHessian, AddsAnotherOfTheSamePattern) {
  BlockHessian<2> a(small_pattern()), b(small_pattern());
  a.add(2, 0, Matrix<2>::Ones());
  b.add(0, 2, 2 * Matrix<2>::Ones());
  a += b;
  EXPECT_EQ(a.block(a.pattern().slot(2, 0)), 3 * Matrix<2>::Ones());
  a.set_zero();
  EXPECT_EQ(a.to_sparse().norm(), 0);
  BlockHessian<2> other(std::make_shared<HessianPattern>(4, std::vector<std::pair<int, int>>{}));
  EXPECT_THROW(a += other, InvalidInput);
}

}  // namespace crease
