#include "Optimizers/Optimizer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Optimizers/GaussNewton.h"
#include "Optimizers/Lbfgs.h"
#include "Optimizers/NonlinearConjugateGradient.h"
#include "Optimizers/SteepestDescent.h"
#include "Testing/Optimizers/Problems.h"

namespace crease {
namespace {

struct Method {
  const char* name;
  std::function<std::unique_ptr<Optimizer>(const OptimizerOptions&)> make;
};

template <LinearSolver Solver>
std::unique_ptr<Optimizer> gauss_newton(const OptimizerOptions& stopping) {
  return std::make_unique<GaussNewton>(stopping,
                                       GaussNewtonOptions{.linear_solver = {.kind = Solver}});
}

const Method kMethods[] = {
    {"GaussNewtonDirect", gauss_newton<LinearSolver::kDirect>},
    {"GaussNewtonPreconditionedCg", gauss_newton<LinearSolver::kPreconditionedCg>},
    {"GaussNewtonScalarCg", gauss_newton<LinearSolver::kScalarPreconditionedCg>},
    {"Lbfgs", [](const OptimizerOptions& stopping) { return std::make_unique<Lbfgs>(stopping); }},
    {"ConjugateGradient",
     [](const OptimizerOptions& stopping) {
       return std::make_unique<NonlinearConjugateGradient>(stopping);
     }},
    {"SteepestDescent",
     [](const OptimizerOptions& stopping) { return std::make_unique<SteepestDescent>(stopping); }},
};

const OptimizerOptions kStrict{
    .relative_decrease = 1e-12, .relative_gradient = 1e-9, .max_iterations = 3000};

testing::ConvexFunction convex_problem(int side, int columns) {
  std::mt19937 random(11);
  return {testing::grid_hessian(side, columns, 3, 2),
          10.0 * testing::random_vector(side * side * columns, random), 40.0};
}

// Turns into NaN or infinity at the given evaluation.
class Faulty final : public ObjectiveFunction {
 public:
  enum class Part { kValue, kGradient, kHessian };
  Faulty(Part part, int when) : part_(part), when_(when) {}
  Eigen::Index size() const override { return inner_.size(); }
  double evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient,
                  Eigen::SparseMatrix<double>* hessian) override {
    double value = inner_.evaluate(x, gradient, hessian);
    if (++calls_ < when_) return value;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    if (part_ == Part::kValue) value = nan;
    if (part_ == Part::kGradient && gradient != nullptr) (*gradient)[3] = nan;
    if (part_ == Part::kHessian && hessian != nullptr) hessian->coeffRef(4, 2) = nan;
    return value;
  }

 private:
  testing::ConvexFunction inner_ = convex_problem(4, 1);
  Part part_;
  int when_;
  int calls_ = 0;
};

}  // namespace

class EveryOptimizer : public ::testing::TestWithParam<Method> {};

INSTANTIATE_TEST_SUITE_P(Methods, EveryOptimizer, ::testing::ValuesIn(kMethods),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(EveryOptimizer, FindsTheSameMinimumInEveryNullSpace) {
  auto function = convex_problem(7, 2);
  const auto constraints = testing::landmark_constraints(7, 8, 2, 3);
  const auto space = make_null_space(NullSpaceKind::kElimination, constraints, 49);
  const Eigen::VectorXd start = Eigen::VectorXd::Zero(98);
  const auto reference =
      GaussNewton(OptimizerOptions{.relative_decrease = 0.0, .relative_gradient = 1e-12},
                  {.linear_solver = {.kind = LinearSolver::kDirect}})
          .minimize(function, start, space.get());
  Eigen::VectorXd gradient;
  function.evaluate(reference.x, &gradient, nullptr);
  ASSERT_LE(space->apply_transpose(gradient).norm(), 1e-6);
  for (auto kind : {NullSpaceKind::kElimination, NullSpaceKind::kQr, NullSpaceKind::kSvd}) {
    const auto other = make_null_space(kind, constraints, 49);
    const auto result = GetParam().make(kStrict)->minimize(function, start, other.get());
    EXPECT_NEAR(result.value, reference.value, 1e-6 * std::abs(reference.value));
    EXPECT_LE((result.x - reference.x).norm(), 1e-3 * reference.x.norm());
  }
}

TEST_P(EveryOptimizer, KeepsTheConstraintsWhateverTheStop) {
  auto function = convex_problem(7, 2);
  const auto constraints = testing::landmark_constraints(7, 8, 2, 3);
  const Eigen::VectorXd start = Eigen::VectorXd::Ones(98);
  for (auto kind : {NullSpaceKind::kElimination, NullSpaceKind::kQr, NullSpaceKind::kSvd}) {
    const auto space = make_null_space(kind, constraints, 49);
    const auto run = [&](const OptimizerOptions& stopping, const ProgressCallback& progress) {
      return GetParam().make(stopping)->minimize(function, start, space.get(), progress);
    };
    const auto none = run({.max_iterations = 0}, {});
    EXPECT_EQ(none.reason, StopReason::kIterationLimit);
    const auto one = run({.max_iterations = 1}, {});
    EXPECT_EQ(one.reason, StopReason::kIterationLimit);
    EXPECT_EQ(one.iterations, 1);
    const auto cancelled =
        run({}, [](const IterationRecord& record) { return record.iteration < 2; });
    EXPECT_EQ(cancelled.reason, StopReason::kCancelled);
    EXPECT_EQ(cancelled.iterations, 2);
    const auto late = run({.max_seconds = 0.0}, {});
    EXPECT_EQ(late.reason, StopReason::kTimeLimit);
    const auto finished = run(kStrict, {});
    for (const auto* result : {&none, &one, &cancelled, &late, &finished}) {
      EXPECT_LE(testing::violation(constraints, result->x), 1e-12);
    }
  }
}

TEST_P(EveryOptimizer, TheValueFallsInEveryIteration) {
  auto function = convex_problem(6, 2);
  const auto result =
      GetParam().make(kStrict)->minimize(function, 20.0 * Eigen::VectorXd::Ones(72));
  ASSERT_EQ(static_cast<int>(result.history.size()), result.iterations + 1);
  for (std::size_t i = 1; i < result.history.size(); ++i) {
    EXPECT_LT(result.history[i].value, result.history[i - 1].value);
    EXPECT_EQ(result.history[i].iteration, static_cast<int>(i));
    EXPECT_GE(result.history[i].evaluations, 1);
  }
  EXPECT_EQ(result.history.back().value, result.value);
  EXPECT_EQ(result.history.front().value, result.initial_value);
  EXPECT_EQ(result.num_evaluations, function.evaluations);
  EXPECT_TRUE(result.improved());
}

TEST_P(EveryOptimizer, StaysAtAMinimum) {
  testing::Rosenbrock function;
  const auto result = GetParam().make({})->minimize(function, Eigen::Vector2d(1, 1));
  EXPECT_EQ(result.x, Eigen::Vector2d(1, 1));
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(result.reason, StopReason::kSmallGradient);
  EXPECT_FALSE(result.improved());
}

TEST_P(EveryOptimizer, StopsAtAShortStep) {
  auto function = convex_problem(6, 1);
  const auto result =
      GetParam()
          .make({.relative_decrease = 0.0, .relative_gradient = 0.0, .step_length = 0.05})
          ->minimize(function, 5.0 * Eigen::VectorXd::Ones(36));
  EXPECT_EQ(result.reason, StopReason::kSmallStep);
  EXPECT_LT(result.history.back().step, 0.05);
  for (std::size_t i = 1; i + 1 < result.history.size(); ++i)
    EXPECT_GE(result.history[i].step, 0.05);
}

TEST_P(EveryOptimizer, StopsAfterSuccessiveSmallDecreases) {
  auto function = convex_problem(6, 1);
  const auto result =
      GetParam()
          .make({.relative_decrease = 1e-2, .small_decreases = 2, .relative_gradient = 0.0})
          ->minimize(function, 5.0 * Eigen::VectorXd::Ones(36));
  EXPECT_EQ(result.reason, StopReason::kSmallDecrease);
  const auto& history = result.history;
  ASSERT_GE(history.size(), 3U);
  const auto decrease = [&](std::size_t i) {
    return (history[i - 1].value - history[i].value) / std::abs(history[i - 1].value);
  };
  EXPECT_LT(decrease(history.size() - 1), 1e-2);
  EXPECT_LT(decrease(history.size() - 2), 1e-2);
  EXPECT_FALSE(result.reason_text.empty());
}

TEST_P(EveryOptimizer, SameBytesOnAnyNumberOfThreads) {
  const auto constraints = testing::landmark_constraints(12, 10, 2, 3);
  Eigen::VectorXd reference;
  for (int threads : {1, 2, 8}) {
    set_num_threads(threads);
    auto function = convex_problem(12, 2);
    const auto space = make_null_space(NullSpaceKind::kElimination, constraints, 144);
    const auto result = GetParam()
                            .make({.max_iterations = 5})
                            ->minimize(function, Eigen::VectorXd::Ones(288), space.get());
    if (threads == 1) reference = result.x;
    EXPECT_EQ(std::memcmp(result.x.data(), reference.data(), sizeof(double) * reference.size()), 0);
  }
  set_num_threads(0);
}

TEST_P(EveryOptimizer, NamesTheIterationInWhichTheValueIsNotANumber) {
  Faulty function(Faulty::Part::kValue, 2);
  EXPECT_THAT([&] { GetParam().make({})->minimize(function, Eigen::VectorXd::Ones(16)); },
              ::testing::ThrowsMessage<SolverError>(::testing::AllOf(
                  ::testing::HasSubstr("value"), ::testing::HasSubstr("iteration 1"))));
}

TEST_P(EveryOptimizer, NamesTheEntryOfTheGradientThatIsNotANumber) {
  Faulty function(Faulty::Part::kGradient, 1);
  EXPECT_THAT([&] { GetParam().make({})->minimize(function, Eigen::VectorXd::Ones(16)); },
              ::testing::ThrowsMessage<SolverError>(::testing::AllOf(
                  ::testing::HasSubstr("entry 3 of the gradient"), ::testing::HasSubstr("start"))));
}

TEST_P(EveryOptimizer, RefusesSizesThatDiffer) {
  auto function = convex_problem(4, 1);
  const auto space = make_null_space(NullSpaceKind::kElimination, no_constraints(9, 2), 9);
  const auto optimizer = GetParam().make({});
  EXPECT_THROW(optimizer->minimize(function, Eigen::VectorXd::Ones(15)), InvalidInput);
  EXPECT_THROW(optimizer->minimize(function, Eigen::VectorXd::Ones(16), space.get()), InvalidInput);
}

TEST_P(EveryOptimizer, AllUnknownsFixedByConstraints) {
  auto function = convex_problem(4, 1);
  auto constraints = testing::landmark_constraints(4, 16, 1, 3);
  constraints.d *= 1e-6;
  const auto space = make_null_space(NullSpaceKind::kElimination, constraints, 16);
  ASSERT_EQ(space->reduced_size(), 0);
  const auto result =
      GetParam().make({})->minimize(function, Eigen::VectorXd::Ones(16), space.get());
  EXPECT_LE(testing::violation(constraints, result.x), 1e-9);
  EXPECT_EQ(result.iterations, 0);
}

// With the Hessian at the start as preconditioner, full first steps lead beyond the barrier.
TEST_P(EveryOptimizer, RejectsTrialPointsOfInfiniteValue) {
  testing::Barrier barrier;
  Eigen::SparseMatrix<double> P(1, 1);
  P.insert(0, 0) = 0.1;
  testing::PreconditionedFunction function(barrier, P);
  const auto result =
      GetParam()
          .make({.relative_decrease = 0.0, .relative_gradient = 1e-7, .max_iterations = 500})
          ->minimize(function, Eigen::VectorXd::Constant(1, 1.0));
  EXPECT_NEAR(result.x[0], 0.1, 1e-6);
  EXPECT_GT(barrier.infinite, 0);
}

TEST_P(EveryOptimizer, PassesOnWhatTheFunctionThrows) {
  class Refusing final : public ObjectiveFunction {
   public:
    Eigen::Index size() const override { return 2; }
    double evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient,
                    Eigen::SparseMatrix<double>* hessian) override {
      if (++calls > 3) throw InvalidInput("no more");
      return inner.evaluate(x, gradient, hessian);
    }
    testing::Rosenbrock inner;
    int calls = 0;
  } function;
  EXPECT_THAT([&] { GetParam().make({})->minimize(function, Eigen::Vector2d(-1.2, 1.0)); },
              ::testing::ThrowsMessage<InvalidInput>("no more"));
}

TEST(GaussNewton, NamesTheEntryOfTheHessianThatIsNotANumber) {
  for (auto kind : {LinearSolver::kDirect, LinearSolver::kPreconditionedCg,
                    LinearSolver::kScalarPreconditionedCg}) {
    Faulty function(Faulty::Part::kHessian, 3);
    const GaussNewton optimizer({}, {.linear_solver = {.kind = kind}});
    EXPECT_THAT([&] { optimizer.minimize(function, 30.0 * Eigen::VectorXd::Ones(16)); },
                ::testing::ThrowsMessage<SolverError>(::testing::AllOf(
                    ::testing::HasSubstr("(4, 2)"), ::testing::HasSubstr("iteration 3"))));
  }
}

TEST(GaussNewton, FollowsRosenbrocksValley) {
  testing::Rosenbrock function;
  const auto result =
      GaussNewton({.relative_gradient = 1e-10}).minimize(function, Eigen::Vector2d(-1.2, 1.0));
  EXPECT_LE((result.x - Eigen::Vector2d(1, 1)).norm(), 1e-6);
  EXPECT_LE(result.num_evaluations, 100);
}

TEST(GaussNewton, SolvesConstrainedNonlinearLeastSquares) {
  std::mt19937 random(4);
  const auto constraints = testing::landmark_constraints(6, 5, 2, 3);
  const auto space = make_null_space(NullSpaceKind::kElimination, constraints, 36);
  const Eigen::VectorXd solution =
      space->expand(testing::random_vector(space->reduced_size(), random));
  testing::SineResiduals function(
      testing::random_matrix(90, 72, random) / 6.0 + Eigen::MatrixXd::Identity(90, 72), solution);
  const auto result =
      GaussNewton({.relative_gradient = 1e-12, .max_iterations = 60})
          .minimize(function, solution + 0.3 * testing::random_vector(72, random), space.get());
  EXPECT_LE((result.x - solution).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LE(testing::violation(constraints, result.x), 1e-12);
}

TEST(GaussNewton, StackedConstraintsReachTheSameMinimumAsColumns) {
  auto function = convex_problem(6, 2);
  const auto columns = testing::landmark_constraints(6, 5, 2, 3);
  LinearConstraints stacked;
  std::vector<Eigen::Triplet<double>> entries;
  stacked.d.resize(10, 1);
  for (int row = 0; row < 5; ++row) {
    for (int a = 0; a < 2; ++a) {
      stacked.d(2 * row + a, 0) = columns.d(row, a);
      for (decltype(columns.C)::InnerIterator entry(columns.C, row); entry; ++entry) {
        entries.emplace_back(2 * row + a, 2 * static_cast<int>(entry.col()) + a, entry.value());
      }
    }
  }
  stacked.C.resize(10, 72);
  stacked.C.setFromTriplets(entries.begin(), entries.end());
  const auto one = make_null_space(NullSpaceKind::kElimination, columns, 36);
  const auto other = make_null_space(NullSpaceKind::kElimination, stacked, 72);
  const Eigen::VectorXd start = Eigen::VectorXd::Zero(72);
  const auto a = GaussNewton(kStrict).minimize(function, start, one.get());
  const auto b = GaussNewton(kStrict).minimize(function, start, other.get());
  EXPECT_NEAR(a.value, b.value, 1e-9 * std::abs(a.value));
  EXPECT_LE(testing::violation(columns, b.x), 1e-12);
}

TEST(GaussNewton, QuadraticFunctionsNeedOneUndampedStep) {
  std::mt19937 random(1);
  testing::ConvexFunction function(testing::grid_hessian(6, 2, 3, 2),
                                   testing::random_vector(72, random), 0.0);
  const auto result =
      GaussNewton({.relative_gradient = 1e-9},
                  {.linear_solver = {.kind = LinearSolver::kDirect}, .initial_damping = 0.0})
          .minimize(function, Eigen::VectorXd::Zero(72));
  EXPECT_EQ(result.iterations, 1);
  EXPECT_EQ(result.num_evaluations, 2);
  EXPECT_EQ(result.num_factorizations, 1);
}

TEST(GaussNewton, KeepsItsPreconditioner) {
  auto function = convex_problem(10, 2);
  const Eigen::VectorXd start = 3.0 * Eigen::VectorXd::Ones(200);
  const auto direct =
      GaussNewton({}, {.linear_solver = {.kind = LinearSolver::kDirect}}).minimize(function, start);
  EXPECT_EQ(direct.num_factorizations, direct.iterations);
  const auto kept = GaussNewton({}, {.linear_solver = {.kind = LinearSolver::kPreconditionedCg}})
                        .minimize(function, start);
  EXPECT_EQ(kept.num_factorizations, 1);
  EXPECT_NEAR(kept.value, direct.value, 1e-5 * std::abs(direct.value));
  int linear_iterations = 0;
  for (const auto& record : kept.history) linear_iterations += record.linear_iterations;
  EXPECT_GE(linear_iterations, kept.iterations - 1);
}

TEST(GaussNewton, FactorsAnewWhenItsPreconditionerHasBecomePoor) {
  auto function = convex_problem(10, 2);
  const GaussNewton optimizer({}, {.linear_solver = {.kind = LinearSolver::kPreconditionedCg,
                                                     .cg_tolerance = 1e-6,
                                                     .max_cg_iterations = 1}});
  const auto result = optimizer.minimize(function, 3.0 * Eigen::VectorXd::Ones(200));
  EXPECT_GT(result.num_factorizations, 1);
  EXPECT_TRUE(result.improved());
}

TEST(GaussNewton, UnknownsThatTheFunctionDoesNotSeeStayPut) {
  Eigen::SparseMatrix<double> A = testing::grid_hessian(5, 2, 2, 2);
  for (int j = 0; j < 50; ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(A, j); entry; ++entry) {
      if (entry.row() == 7 || j == 7) entry.valueRef() = 0.0;
    }
  }
  std::mt19937 random(1);
  Eigen::VectorXd b = testing::random_vector(50, random);
  b[7] = 0.0;
  for (auto kind : {LinearSolver::kDirect, LinearSolver::kPreconditionedCg,
                    LinearSolver::kScalarPreconditionedCg}) {
    testing::ConvexFunction function(A, b, 0.0);
    const auto result = GaussNewton({.relative_gradient = 1e-10}, {.linear_solver = {.kind = kind}})
                            .minimize(function, 2.0 * Eigen::VectorXd::Ones(50));
    EXPECT_EQ(result.x[7], 2.0);
    EXPECT_LE((A.selfadjointView<Eigen::Lower>() * result.x - b).norm(), 1e-6);
  }
}

// 20 points of two components each; `coupling` near 1 leaves the sum of the two almost free.
Eigen::SparseMatrix<double> coupled_pairs(double coupling) {
  Eigen::SparseMatrix<double> A(40, 40);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < 20; ++i) {
    const double strength = std::pow(10.0, i * 0.2);
    entries.emplace_back(2 * i, 2 * i, strength + 0.01);
    entries.emplace_back(2 * i + 1, 2 * i + 1, strength + 0.01);
    entries.emplace_back(2 * i + 1, 2 * i, -coupling * strength);
  }
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

void expect_minimum(const GaussNewton& optimizer, const Eigen::SparseMatrix<double>& A) {
  std::mt19937 random(1);
  const Eigen::VectorXd solution = testing::random_vector(40, random);
  testing::ConvexFunction function(A, A.selfadjointView<Eigen::Lower>() * solution, 0.0);
  const auto space = make_null_space(NullSpaceKind::kElimination, no_constraints(20, 2), 20);
  const auto result = optimizer.minimize(function, Eigen::VectorXd::Zero(40), space.get());
  EXPECT_LE((result.x - solution).norm(), 1e-5);
}

const OptimizerOptions kToTheEnd{.relative_decrease = 0.0, .relative_gradient = 1e-10};
const LinearSolverOptions kImpatient{
    .kind = LinearSolver::kScalarPreconditionedCg, .cg_tolerance = 1e-8, .max_cg_iterations = 1};

// Strongly coupled components: the scalar factor fails and the full one takes its place.
TEST(GaussNewton, ScalarPreconditionerFallsBackToTheFullFactor) {
  const GaussNewton optimizer(kToTheEnd, {.linear_solver = kImpatient, .initial_damping = 0.0});
  expect_minimum(optimizer, coupled_pairs(1));
}

TEST(GaussNewton, ScalarFactorOfAnEarlierMinimisationGivesWayToo) {
  GaussNewtonOptions options{.linear_solver = kImpatient, .initial_damping = 0.0};
  options.solver = std::make_shared<DampedSolver>(kImpatient, 2);
  const GaussNewton optimizer(kToTheEnd, options);
  expect_minimum(optimizer, coupled_pairs(1e-12));
  EXPECT_EQ(options.solver->num_factorizations(), 1);  // scalar, and good
  expect_minimum(optimizer, coupled_pairs(1));
}

// E = x^4/4 - x^2/2 at its maximum-like start: the exact Hessian is negative there.
class DoubleWell final : public ObjectiveFunction {
 public:
  Eigen::Index size() const override { return 1; }
  double evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient,
                  Eigen::SparseMatrix<double>* hessian) override {
    const double t = x[0];
    if (gradient != nullptr) (*gradient)[0] = t * t * t - t;
    if (hessian != nullptr) {
      hessian->resize(1, 1);
      hessian->coeffRef(0, 0) = 3 * t * t - 1;
    }
    return t * t * t * t / 4 - t * t / 2;
  }
};

// Between the wells the Hessian is negative; damping by its absolute diagonal makes it positive.
TEST(GaussNewton, LeavesAHilltopByDamping) {
  DoubleWell function;
  EXPECT_NEAR(GaussNewton().minimize(function, Eigen::VectorXd::Constant(1, 0.1)).x[0], 1, 1e-4);
}

TEST(GaussNewton, SaysThatTheHessianIsNotPositiveDefinite) {
  class Saddle final : public ObjectiveFunction {  // x y: a diagonal of zeros damps nothing
   public:
    Eigen::Index size() const override { return 2; }
    double evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient,
                    Eigen::SparseMatrix<double>* hessian) override {
      if (gradient != nullptr) *gradient = Eigen::Vector2d(x[1], x[0]);
      if (hessian != nullptr) *hessian = Eigen::Matrix2d{{0, 1}, {1, 0}}.sparseView();
      return x[0] * x[1];
    }
  } function;
  EXPECT_THAT([&] { GaussNewton().minimize(function, Eigen::Vector2d(0.1, 0.2)); },
              ::testing::ThrowsMessage<SolverError>(::testing::HasSubstr("not positive definite")));
}

TEST(GaussNewton, ShortensBeforeItDamps) {
  DoubleWell function;  // from 0.6 the full step overshoots far beyond the well
  const auto result =
      GaussNewton({.relative_gradient = 1e-9},
                  {.linear_solver = {.kind = LinearSolver::kDirect}, .initial_damping = 1e-3})
          .minimize(function, Eigen::VectorXd::Constant(1, 0.6));
  EXPECT_NEAR(result.x[0], 1.0, 1e-6);
  EXPECT_GT(result.history[1].evaluations, 1);
  EXPECT_EQ(result.history[1].factorizations, 1);
}

TEST(GaussNewton, NeedsAHessian) {
  class NoHessian final : public ObjectiveFunction {
   public:
    Eigen::Index size() const override { return 2; }
    double evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient,
                    Eigen::SparseMatrix<double>*) override {
      if (gradient != nullptr) *gradient = x;
      return 0.5 * x.squaredNorm();
    }
    bool has_hessian() const override { return false; }
  } function;
  EXPECT_THROW(GaussNewton().minimize(function, Eigen::Vector2d(1, 2)), InvalidInput);
  EXPECT_LE(SteepestDescent().minimize(function, Eigen::Vector2d(1, 2)).x.norm(), 1e-5);
}

TEST(GaussNewton, RefusesOptionsOutOfRange) {
  EXPECT_THROW(GaussNewton({.small_decreases = 0}), InvalidInput);
  EXPECT_THROW(GaussNewton({.relative_decrease = std::nan("")}), InvalidInput);
  EXPECT_THROW(GaussNewton({}, {.shortening = 1.5}), InvalidInput);
  EXPECT_THROW(GaussNewton({}, {.linear_solver = {.cg_tolerance = 0.0}}), InvalidInput);
  EXPECT_THROW(SteepestDescent({}, {.first_step = 0.0}), InvalidInput);
  EXPECT_THROW(Lbfgs({}, {.memory = 0}), InvalidInput);
  EXPECT_THROW(Lbfgs({.max_iterations = -1}), InvalidInput);
  EXPECT_THROW(NonlinearConjugateGradient({}, {.first_step = 0.0}), InvalidInput);
}
}  // namespace crease
