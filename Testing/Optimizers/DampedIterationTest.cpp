#include "Optimizers/DampedIteration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Optimizers/GaussNewton.h"
#include "Testing/Optimizers/Problems.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// 1/2 x^T M x + 1/2 w |x - target|^2: the largest eigenvalue of M^-1 w is w over M's smallest.
class SpringsOnABody final : public ObjectiveFunction {
 public:
  SpringsOnABody(const Eigen::SparseMatrix<double>& M, double weight, Eigen::VectorXd target)
      : M_(M), weight_(weight), target_(std::move(target)) {}
  Eigen::Index size() const override { return target_.size(); }
  double evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient,
                  Eigen::SparseMatrix<double>* hessian) override {
    const Eigen::VectorXd force = M_.selfadjointView<Eigen::Lower>() * x;
    if (gradient != nullptr) *gradient = force + weight_ * (x - target_);
    if (hessian != nullptr) {
      Eigen::SparseMatrix<double> identity(size(), size());
      identity.setIdentity();
      *hessian = M_ + weight_ * identity;
    }
    return 0.5 * x.dot(force) + 0.5 * weight_ * (x - target_).squaredNorm();
  }

 private:
  Eigen::SparseMatrix<double> M_;
  double weight_;
  Eigen::VectorXd target_;
};

struct Problem {
  Eigen::SparseMatrix<double> M = testing::grid_hessian(6, 2, 1, 4);
  Eigen::VectorXd target, start;
  std::unique_ptr<NullSpace> null_space =
      make_null_space(NullSpaceKind::kElimination, testing::landmark_constraints(6, 3, 2, 8), 36);
  Problem() {
    std::mt19937 random(2);
    target = testing::random_vector(72, random);
    start = Eigen::VectorXd::Zero(72);
  }
  SpringsOnABody function(double weight) const { return {M, weight, target}; }
};

const OptimizerOptions kStrict{
    .relative_decrease = 1e-13, .relative_gradient = 1e-9, .max_iterations = 5000};

}  // namespace

TEST(DampedIteration, ReachesTheMinimumOfGaussNewton) {
  const Problem problem;
  auto function = problem.function(0.5);
  const auto damped = DampedIteration(problem.M, kStrict, {.step = 0.05})
                          .minimize(function, problem.start, problem.null_space.get());
  const auto newton =
      GaussNewton(kStrict).minimize(function, problem.start, problem.null_space.get());
  EXPECT_NEAR(damped.value, newton.value, 1e-9 * newton.value);
  EXPECT_LT((damped.x - newton.x).norm(), 1e-4 * newton.x.norm());
  EXPECT_EQ(damped.num_factorizations, 1);
  EXPECT_LT((problem.null_space->constraints().C * damped.x.reshaped<Eigen::RowMajor>(36, 2) -
             problem.null_space->constraints().d)
                .norm(),
            1e-10);
}

TEST(DampedIteration, HalvesAStepThatIsTooLong) {
  const Problem problem;
  auto function = problem.function(50);  // h = 1 diverges
  const auto result = DampedIteration(problem.M, kStrict, {.step = 1})
                          .minimize(function, problem.start, problem.null_space.get());
  EXPECT_LT(result.history.back().damping, 1);
  for (std::size_t i = 1; i < result.history.size(); ++i) {
    EXPECT_LT(result.history[i].value, result.history[i - 1].value);
  }
}

TEST(DampedIteration, SaysWhenNoStepHelps) {
  const Problem problem;
  auto function = problem.function(1e7);
  EXPECT_THAT(
      [&] {
        DampedIteration(problem.M, kStrict, {.step = 1})
            .minimize(function, problem.start, problem.null_space.get());
      },
      ThrowsMessage<SolverError>(HasSubstr("halved 10 times")));
}

TEST(DampedIteration, RefusesBadOptionsAndFreeBodies) {
  const Problem problem;
  EXPECT_THROW(DampedIteration(problem.M, kStrict, {.step = 0}), InvalidInput);
  EXPECT_THROW(DampedIteration(problem.M, kStrict, {.max_halvings = -1}), InvalidInput);
  auto function = problem.function(1);
  EXPECT_THAT(
      [&] {
        DampedIteration(Eigen::SparseMatrix<double>(72, 72), kStrict)
            .minimize(function, problem.start);
      },
      ThrowsMessage<SolverError>(HasSubstr("positive definite")));
}

}  // namespace crease
