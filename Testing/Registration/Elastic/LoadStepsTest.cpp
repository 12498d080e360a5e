#include "Registration/Elastic/LoadSteps.h"

#include <gmock/gmock.h>

#include "Core/Parallel.h"
#include "Testing/Registration/Elastic/ElasticBodies.h"

namespace crease {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::moderate_load;
using ::testing::Not;

double largest_difference(const LoadStepResult& a, const LoadStepResult& b) {
  return (a.control_points - b.control_points).cwiseAbs().maxCoeff();
}

/// Largest distance of a mapped pair from its partner, with a share of the load.
double pair_error(const ElasticDeformation& deformation, const LoadStepResult& result) {
  const auto transform = transform_of(deformation, result);
  double error = 0;
  for (int j = 0; j < deformation.pairs.size(); ++j) {
    const Point<2>& p = deformation.pairs.fixed[j];
    const Point<2> target = p + result.fraction * (deformation.pairs.moving[j] - p);
    error = std::max(error, (transform.map(p) - target).norm());
  }
  return error;
}

/// A column of 10 x 1 mm, clamped at both ends, buckles under 4 pi^2 / 12 / 100 = 3.3 % of compression. Pushed
/// straight down it stays straight, for the mesh is symmetric: an equilibrium that a small push would end.
ElasticDeformation column(double compression) {
  DomainMesh domain;
  domain.mesh = structured_triangulation(testing::box(0, 0, 1, 10), 2, 20);
  ElasticDeformation deformation;
  deformation.basis = testing::spline_on(domain, {.degree = 2, .collapse_all = true});
  deformation.material.tissue = {.young = 1, .poisson = 0};
  for (const double y : {0.0, 10.0}) {
    for (const double x : {0.0, 0.5, 1.0}) {
      deformation.pairs.fixed.emplace_back(x, y);
      deformation.pairs.moving.emplace_back(x, y * (1 - compression));
    }
  }
  return deformation;
}

}  // namespace

TEST(LoadSteps, ReachTheSameStateInAnyNumberOfSteps) {
  const auto deformation = moderate_load();
  const LoadStepOptions exact{.tolerance = 1e-11};
  auto with_steps = [&](int steps) {
    LoadStepOptions options = exact;
    options.steps = steps;
    return deform_elastically(deformation, options);
  };
  const auto twenty = with_steps(20);
  EXPECT_EQ(std::ssize(twenty.steps), 20);
  EXPECT_EQ(twenty.fraction, 1);
  EXPECT_GT(twenty.least_determinant.value, 0.3);
  EXPECT_LT(largest_difference(twenty, with_steps(10)), 1e-8);
  EXPECT_LT(largest_difference(twenty, with_steps(1)), 1e-8);
  LoadStepOptions adaptive = exact;
  adaptive.schedule = LoadSchedule::kAdaptive;
  const auto grown = deform_elastically(deformation, adaptive);
  EXPECT_LT(largest_difference(twenty, grown), 1e-8);
  EXPECT_LT(grown.factorizations, twenty.factorizations / 3);
}

TEST(LoadSteps, NewtonConvergesQuadratically) {
  const auto result = deform_elastically(moderate_load(), {.steps = 1, .tolerance = 1e-12});
  const auto& r = result.steps.front().residuals;
  ASSERT_GE(r.size(), 4U);
  // The last residual is at rounding; the two before it and their predecessor tell.
  const std::size_t last = r.size() - 1;
  const double early = r[last - 2] / std::pow(r[last - 3], 2);
  const double late = r[last - 1] / std::pow(r[last - 2], 2);
  EXPECT_LT(late, 10 * early) << ::testing::PrintToString(r);
  EXPECT_LT(r[last - 1], 1e-2 * r[last - 2]);
}

TEST(LoadSteps, MeetThePairsAtEveryStep) {
  const auto deformation = moderate_load();
  for (int stop : {1, 7, 13, 20}) {
    const auto result = deform_elastically(
        deformation, {}, [&](const LoadStepRecord& record) { return record.step < stop; });
    EXPECT_NEAR(result.fraction, stop / 20.0, 1e-12);
    EXPECT_LT(pair_error(deformation, result), 1e-9 * 95);
  }
}

// Forward Euler drifts off the equilibrium by an error of first order.
TEST(LoadSteps, EulerErrorFallsLikeOneOverN) {
  const auto deformation = moderate_load(14, 0.5);
  const auto exact = deform_elastically(deformation, {.steps = 4, .tolerance = 1e-11});
  double previous = 0;
  for (int steps : {10, 20, 40, 80}) {
    const auto euler =
        deform_elastically(deformation, {.steps = steps, .corrector = LoadCorrector::kNone});
    EXPECT_LT(pair_error(deformation, euler), 1e-9);
    const double error = largest_difference(euler, exact);
    if (previous > 0) EXPECT_NEAR(std::log2(previous / error), 1, 0.1) << steps;
    previous = error;
  }
}

TEST(LoadSteps, DoNotDependOnTheUnitOfStress) {
  auto deformation = moderate_load();
  const auto once = deform_elastically(deformation, {.steps = 4});
  deformation.material.tissue.young *= 100;
  deformation.material.regions[1].young *= 100;
  const auto scaled = deform_elastically(deformation, {.steps = 4});
  EXPECT_LT(largest_difference(once, scaled), 1e-9);
  EXPECT_LT((scaled.reactions - 100 * once.reactions).norm(), 1e-7 * scaled.reactions.norm());
}

// No other force acts: the reactions balance each other, and their moments too.
TEST(LoadSteps, ReactionsBalance) {
  const auto deformation = moderate_load();
  const auto result = deform_elastically(deformation, {.steps = 2, .tolerance = 1e-11});
  ASSERT_EQ(result.reactions.rows(), deformation.pairs.size());
  const double size = result.reactions.norm();
  EXPECT_GT(size, 0.1);
  EXPECT_LT(result.reactions.colwise().sum().norm(), 1e-9 * size);
  double moment = 0;
  for (int j = 0; j < deformation.pairs.size(); ++j) {
    const Point<2>& q = deformation.pairs.moving[j];
    moment += q.x() * result.reactions(j, 1) - q.y() * result.reactions(j, 0);
  }
  EXPECT_LT(std::abs(moment), 1e-9 * size * 95);
  EXPECT_NEAR(result.steps.back().largest_reaction, result.reactions.rowwise().norm().maxCoeff(),
              1e-12);
}

TEST(LoadSteps, ConjugateGradientsWithAnEarlierFactorReachTheSame) {
  const auto deformation = moderate_load();
  const auto direct = deform_elastically(deformation, {.steps = 5, .tolerance = 1e-10});
  const auto cg = deform_elastically(
      deformation, {.steps = 5, .tolerance = 1e-10, .solver = LinearSolver::kPreconditionedCg});
  EXPECT_LT(largest_difference(direct, cg), 1e-8);
  EXPECT_LT(cg.factorizations, direct.factorizations / 2);
}

TEST(LoadSteps, NullSpacesGiveTheSame) {
  const auto deformation = moderate_load();
  const auto elimination = deform_elastically(deformation, {.steps = 3, .tolerance = 1e-10});
  const auto qr = deform_elastically(
      deformation, {.steps = 3, .tolerance = 1e-10, .null_space = NullSpaceKind::kQr});
  EXPECT_LT(largest_difference(elimination, qr), 1e-8);
}

// A slide along x = 0 that is free in y, and one held point: constraints that couple coordinates.
TEST(LoadSteps, TakeConstraintsOnSingleCoordinates) {
  DomainMesh domain;
  domain.mesh = structured_triangulation(testing::box(0, 0, 4, 2), 4, 2);
  const auto basis = testing::spline_on(domain, {.degree = 2, .collapse_all = true});
  ElasticMaterial material;
  material.tissue = {.young = 3, .poisson = 0.3};
  const ControlPoints<2> places = basis->greville_points();
  const int n = basis->num_control_points();
  LinearConstraints constraints;
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> d;
  const auto hold = [&](int i, int axis, double value) {
    entries.emplace_back(static_cast<int>(d.size()), 2 * i + axis, 1.0);
    d.push_back(value);
  };
  for (int i = 0; i < n; ++i) {
    if (places(0, i) < 1e-9) hold(i, 0, 0.0);
    if (places(0, i) > 4 - 1e-9) hold(i, 0, 0.8);
    if (places.col(i).norm() < 1e-9) hold(i, 1, 0.0);
  }
  constraints.C.resize(std::ssize(d), 2 * n);
  constraints.C.setFromTriplets(entries.begin(), entries.end());
  constraints.d = Eigen::Map<Eigen::VectorXd>(d.data(), std::ssize(d));
  const auto result =
      run_load_steps(ElasticEnergy<2>(*basis, material), *basis, constraints, {.steps = 4});
  // Uniaxial stress: S_11 = E (s^2 - 1) / 2, E_22 = -nu E_11, s = 1.2.
  const double strain = 0.5 * (1.44 - 1), narrow = std::sqrt(1 - 2 * 0.3 * strain);
  for (int i = 0; i < n; ++i) {
    EXPECT_NEAR(result.control_points(0, i), 0.2 * places(0, i), 1e-10);
    EXPECT_NEAR(result.control_points(1, i), (narrow - 1) * places(1, i), 1e-10);
  }
  double pull = 0;
  for (std::size_t r = 0; r < d.size(); ++r) {
    if (d[r] > 0) pull += result.reactions(r, 0);
  }
  EXPECT_NEAR(pull, 1.2 * 3 * strain * 2, 1e-9);
}

/// Squeezed between two rows of points 30 mm apart, to a width in mm.
ElasticDeformation squeezed(double width) {
  auto deformation = moderate_load(20);
  deformation.pairs = {};
  for (double y : {-30.0, -10.0, 10.0, 30.0}) {
    deformation.pairs.fixed.emplace_back(5, y);
    deformation.pairs.moving.emplace_back(5, y);
    deformation.pairs.fixed.emplace_back(35, y);
    deformation.pairs.moving.emplace_back(5 + width, y);
  }
  return deformation;
}

TEST(LoadSteps, NameTheLoadAndThePlaceWhereTheyFail) {
  const auto deformation = squeezed(3);
  try {
    deform_elastically(deformation, {.steps = 10, .max_halvings = 2});
    FAIL() << "an equilibrium was found";
  } catch (const NoEquilibrium& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("beyond load fraction"));
    EXPECT_THAT(failure.what(), HasSubstr(") mm"));
    EXPECT_THAT(failure.what(), HasSubstr("neo-Hookean"));
    const LoadStepResult& last = failure.last_state();
    EXPECT_GT(last.fraction, 0.1);
    EXPECT_LT(last.fraction, 1);
    EXPECT_GT(last.least_determinant.value, 0);
    EXPECT_LT(pair_error(deformation, last), 1e-7);
    EXPECT_EQ(last.steps.back().fraction, last.fraction);
  }
}

// However small the steps may become.
TEST(LoadSteps, GiveUpAfterSoManyFailures) {
  try {
    deform_elastically(squeezed(3), {.steps = 10, .max_halvings = 30, .max_failures = 5});
    FAIL() << "an equilibrium was found";
  } catch (const NoEquilibrium& failure) {
    EXPECT_EQ(failure.last_state().failures, 5);
    EXPECT_GT(failure.last_state().least_determinant.value, 0);
  }
  EXPECT_EQ(deform_elastically(moderate_load(20), {.steps = 4}).failures, 0);
}

// Where St. Venant-Kirchhoff tissue folds neo-Hookean tissue holds.
TEST(LoadSteps, NeoHookeanTissueBearsMore) {
  auto deformation = squeezed(12);
  deformation.material.law = ElasticLaw::kNeoHookean;
  const auto result = deform_elastically(deformation, {.steps = 10});
  EXPECT_EQ(result.fraction, 1);
  EXPECT_GT(result.least_determinant.value, 0);
  EXPECT_LT(pair_error(deformation, result), 1e-7);
}

TEST(LoadSteps, SameBytesOnAnyNumberOfThreads) {
  const auto deformation = moderate_load();
  set_num_threads(1);
  const auto one = deform_elastically(deformation, {.steps = 2});
  set_num_threads(4);
  const auto four = deform_elastically(deformation, {.steps = 2});
  set_num_threads(0);
  EXPECT_EQ(one.control_points, four.control_points);
  EXPECT_EQ(one.reactions, four.reactions);
}

TEST(LoadSteps, WarnOfAPairThatIsHeldByLargeForces) {
  auto deformation = moderate_load(14, 0.3);
  deformation.pairs.fixed.emplace_back(21, 1);  // next to pair 15, and astray
  deformation.pairs.moving.emplace_back(22.2, 0.2);
  const auto result = deform_elastically(deformation, {.steps = 4});
  EXPECT_THAT(result.warnings, Contains(HasSubstr("pair 18 is held by")));
  EXPECT_THAT(deform_elastically(moderate_load(14, 0.3), {.steps = 4}).warnings,
              ::testing::IsEmpty());
}

TEST(LoadSteps, FlagUnstableEquilibria) {
  const auto stable = deform_elastically(column(0.025), {.steps = 5});
  EXPECT_FALSE(stable.unstable);
  EXPECT_THAT(stable.warnings, Not(Contains(HasSubstr("unstable"))));
  for (const auto solver : {LinearSolver::kDirect, LinearSolver::kPreconditionedCg}) {
    const auto straight = deform_elastically(column(0.06), {.steps = 5, .solver = solver});
    EXPECT_EQ(straight.fraction, 1);
    EXPECT_LT(straight.steps.back().residual(), 1e-8);
    EXPECT_TRUE(straight.unstable);
    EXPECT_FALSE(straight.steps.front().indefinite_tangent);
    EXPECT_TRUE(straight.steps.back().indefinite_tangent);
    EXPECT_THAT(straight.warnings, Contains(HasSubstr("unstable equilibrium at load fraction 1")));
  }
}

// Pushed aside a little, it leaves the straight equilibrium for one with less energy.
TEST(LoadSteps, FindTheStableEquilibriumBesideAnUnstableOne) {
  const auto straight = deform_elastically(column(0.06), {.steps = 5});
  auto pushed = column(0.06);
  pushed.pairs.fixed.emplace_back(0.5, 5);
  pushed.pairs.moving.emplace_back(1.5, 4.7);
  const auto bent = deform_elastically(pushed, {.steps = 5});
  EXPECT_FALSE(bent.unstable);
  EXPECT_LT(bent.energy, 0.95 * straight.energy);
}

TEST(LoadSteps, RefuseOptionsOutOfRange) {
  const auto deformation = moderate_load(20);
  EXPECT_THROW(deform_elastically(deformation, {.steps = 0}), InvalidInput);
  EXPECT_THROW(deform_elastically(deformation, {.tolerance = 0}), InvalidInput);
  EXPECT_THROW(deform_elastically(deformation, {.max_iterations = 0}), InvalidInput);
  EXPECT_THROW(deform_elastically(deformation, {.max_failures = 0}), InvalidInput);
  EXPECT_THROW(deform_elastically({}, {}), InvalidInput);
}

}  // namespace crease
