#include "Optimizers/NelderMead.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "Core/Error.h"
#include "Optimizers/GaussNewton.h"
#include "Testing/Optimizers/Problems.h"

namespace crease {
namespace {
double rosenbrock(const Eigen::VectorXd& x) {
  return 100 * std::pow(x[1] - x[0] * x[0], 2) + std::pow(1 - x[0], 2);
}
const Eigen::Vector2d kStart(-1.2, 1.0);
const Eigen::Vector2d kSteps(0.5, 0.5);
}  // namespace

TEST(NelderMead, FindsRosenbrocksMinimum) {
  const auto result =
      nelder_mead(rosenbrock, kStart, kSteps, {.size_tolerance = 1e-8, .max_evaluations = 2000});
  EXPECT_TRUE(result.converged);
  EXPECT_LE((result.x - Eigen::Vector2d(1, 1)).norm(), 1e-6);
  EXPECT_DOUBLE_EQ(result.initial_value, rosenbrock(kStart));
  EXPECT_DOUBLE_EQ(result.value, rosenbrock(result.x));
}

TEST(NelderMead, StopsAtTheLimitOfEvaluations) {
  const auto result =
      nelder_mead(rosenbrock, kStart, kSteps, {.size_tolerance = 1e-12, .max_evaluations = 40});
  EXPECT_FALSE(result.converged);
  EXPECT_LE(result.num_evaluations, 45);  // the last iteration is finished
  EXPECT_LT(result.value, result.initial_value);
}

TEST(NelderMead, AvoidsWhereTheFunctionIsNotANumber) {
  const auto half_plane = [](const Eigen::VectorXd& x) {
    return x[0] > 0.5 ? std::numeric_limits<double>::quiet_NaN()
                      : (x - Eigen::Vector2d(1, 2)).norm();
  };
  const auto result = nelder_mead(half_plane, Eigen::Vector2d(0, 0), kSteps,
                                  {.size_tolerance = 1e-7, .max_evaluations = 1000});
  EXPECT_TRUE(result.converged);
  EXPECT_LE((result.x - Eigen::Vector2d(0.5, 2)).norm(), 1e-3);
}

TEST(NelderMead, OneParameter) {
  const auto result =
      nelder_mead([](const Eigen::VectorXd& x) { return std::cos(x[0]); }, Eigen::VectorXd::Ones(1),
                  Eigen::VectorXd::Ones(1), {.size_tolerance = 1e-8});
  EXPECT_NEAR(result.x[0], std::acos(-1.0), 1e-6);
}

TEST(NelderMead, LetsExceptionsThrough) {
  int calls = 0;
  const auto function = [&](const Eigen::VectorXd& x) {
    if (++calls == 10) throw InvalidInput("the tenth call");
    return x.squaredNorm();
  };
  EXPECT_THAT([&] { nelder_mead(function, kStart, kSteps, {.size_tolerance = 1e-9}); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("tenth")));
  EXPECT_EQ(calls, 10);
}

TEST(NelderMead, RefusesBadInput) {
  EXPECT_THROW(nelder_mead(rosenbrock, kStart, Eigen::VectorXd::Ones(3)), InvalidInput);
  EXPECT_THROW(nelder_mead(rosenbrock, kStart, Eigen::Vector2d(1, 0)), InvalidInput);
  EXPECT_THROW(nelder_mead(rosenbrock, Eigen::VectorXd(), Eigen::VectorXd()), InvalidInput);
  const auto bad = [](const Eigen::VectorXd&) { return std::nan(""); };
  EXPECT_THROW(nelder_mead(bad, kStart, kSteps), SolverError);
}
TEST(NelderMead, CallsBackAfterEveryIterationAndMayBeEnded) {
  int calls = 0;
  double last = rosenbrock(kStart);
  NelderMeadOptions options;
  options.after_iteration = [&](const Eigen::VectorXd& x, double value) {
    EXPECT_DOUBLE_EQ(value, rosenbrock(x));
    EXPECT_LE(value, last);
    last = value;
    return ++calls < 7;
  };
  const auto result = nelder_mead(rosenbrock, kStart, kSteps, options);
  EXPECT_EQ(calls, 7);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.value, last);
}

TEST(NelderMeadOptimizer, KeepsConstraintsHistoryAndCancels) {
  testing::ConvexFunction function(testing::grid_hessian(4, 1, 2, 2),
                                   10 * Eigen::VectorXd::Ones(16), 1.0);
  const auto constraints = testing::landmark_constraints(4, 2, 1, 3);
  const auto space = make_null_space(NullSpaceKind::kElimination, constraints, 16);
  const Eigen::VectorXd start = Eigen::VectorXd::Zero(16);
  const auto reference =
      GaussNewton({.relative_decrease = 0.0}).minimize(function, start, space.get());
  function.evaluations = 0;
  const NelderMead optimizer({.relative_gradient = 0.0, .max_iterations = 5000},
                             {.last_size = 1e-6, .max_evaluations = 20000});
  const auto result = optimizer.minimize(function, start, space.get());
  EXPECT_EQ(result.reason, StopReason::kSmallStep);
  EXPECT_NEAR(result.value, reference.value, 1e-6 * std::abs(reference.value));
  EXPECT_LE(testing::violation(constraints, result.x), 1e-12);
  EXPECT_EQ(result.num_evaluations, function.evaluations);
  for (std::size_t i = 1; i < result.history.size(); ++i) {
    EXPECT_LT(result.history[i].value, result.history[i - 1].value);
  }
  const auto cancelled = optimizer.minimize(
      function, start, space.get(), [](const IterationRecord& r) { return r.iteration < 3; });
  EXPECT_EQ(cancelled.reason, StopReason::kCancelled);
  EXPECT_EQ(cancelled.iterations, 3);
  const auto limited =
      NelderMead({}, {.max_evaluations = 30}).minimize(function, start, space.get());
  EXPECT_EQ(limited.reason, StopReason::kIterationLimit);
  EXPECT_LE(testing::violation(constraints, limited.x), 1e-12);
  const auto late = NelderMead({.max_seconds = 0.0}).minimize(function, start, space.get());
  EXPECT_EQ(late.reason, StopReason::kTimeLimit);
}

TEST(NelderMeadOptimizer, IsForFewUnknowns) {
  testing::ConvexFunction function(testing::grid_hessian(6, 1, 2, 2), Eigen::VectorXd::Ones(36),
                                   1.0);
  EXPECT_THAT([&] { NelderMead().minimize(function, Eigen::VectorXd::Zero(36)); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("36 unknowns")));
  EXPECT_THROW(NelderMead({}, {.first_edge = 0.0}), InvalidInput);
}

}  // namespace crease
