// Elastic bodies: set-up, value and derivatives on one thread, and the load steps of a breast of about 600 quadratic
// triangles with 37 pairs, on as many threads as there are.
#include <benchmark/benchmark.h>

#include "Optimizers/SparseCholesky.h"
#include "Registration/LandmarkConstraints.h"
#include "Testing/Benchmarks/Counters.h"
#include "Testing/Benchmarks/Samples.h"
#include "Testing/Registration/Elastic/ElasticBodies.h"

namespace crease::benchmarks {
namespace {

/// About 600 triangles; creases along the line of the stiff corner, or all knots at the vertices.
const ElasticDeformation& breast(bool collapsed) {
  static const auto make = [](bool all) {
    ElasticDeformation deformation;
    deformation.basis =
        testing::spline_on(testing::half_ellipse(5.4), {.degree = 2, .collapse_all = all});
    deformation.material.tissue = {.young = 1, .poisson = 0.495};
    deformation.material.regions[1] = {.young = 10, .poisson = 0.495};
    deformation.pairs = testing::motion_pairs(34);
    return deformation;
  };
  static const ElasticDeformation creased = make(false), lagrange = make(true);
  return collapsed ? lagrange : creased;
}

const TriangularBSplineBasis<2>& spline(bool collapsed) {
  return dynamic_cast<const TriangularBSplineBasis<2>&>(*breast(collapsed).basis);
}

void count_size(benchmark::State& state, bool collapsed) {
  state.counters["triangles"] = static_cast<double>(spline(collapsed).net().mesh.simplices.size());
  state.counters["unknowns"] = 2.0 * spline(collapsed).num_control_points();
}

/// Argument: all knots at the vertices.
void BM_ElasticSetUp(benchmark::State& state) {
  const Threads one_thread;
  const auto& body = breast(state.range(0) != 0);
  for (auto _ : state) benchmark::DoNotOptimize(ElasticEnergy<2>(*body.basis, body.material));
  count_size(state, state.range(0) != 0);
}
BENCHMARK(BM_ElasticSetUp)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

/// Second argument: 0 value, 1 value and gradient, 2 with the exact tangent, 3 with the semi-definite one.
void BM_ElasticEvaluate(benchmark::State& state) {
  const Threads one_thread;
  const auto& body = breast(state.range(0) != 0);
  const ElasticEnergy<2> energy(*body.basis, body.material);
  const auto phi = random_control_points<2>(*body.basis, 0.05);
  ControlPoints<2> gradient = 0 * phi;
  BlockHessian<2> hessian(energy.pattern());
  const auto tangent = state.range(1) == 2 ? ElasticTangent::kExact : ElasticTangent::kSemidefinite;
  for (auto _ : state) {
    benchmark::DoNotOptimize(energy.evaluate(phi, 1, state.range(1) > 0 ? &gradient : nullptr,
                                             state.range(1) > 1 ? &hessian : nullptr, tangent,
                                             nullptr));
  }
  count_time(state, "per_triangle", spline(state.range(0) != 0).net().mesh.simplices.size());
}
BENCHMARK(BM_ElasticEvaluate)->ArgsProduct({{0, 1}, {0, 1, 2, 3}})->Unit(benchmark::kMillisecond);

/// The tangent in the null space of the pairs, factored.
void BM_ElasticFactor(benchmark::State& state) {
  const auto& body = breast(false);
  const ElasticEnergy<2> energy(*body.basis, body.material);
  const auto pairs =
      make_landmark_constraints<2>(body.pairs, *body.basis, {}, {}, NullSpaceKind::kElimination);
  BlockHessian<2> hessian(energy.pattern());
  energy.evaluate(ControlPoints<2>::Zero(2, body.basis->num_control_points()), 1, nullptr,
                  &hessian);
  Eigen::SparseMatrix<double> full, reduced;
  SparseCholesky factor;
  for (auto _ : state) {
    hessian.to_sparse(full);
    pairs.null_space->reduce_hessian(full, reduced);
    benchmark::DoNotOptimize(factor.factor(reduced));
  }
  count_size(state, false);
}
BENCHMARK(BM_ElasticFactor)->Unit(benchmark::kMillisecond);

/// Arguments: number of steps (0: adaptive), threads.
void BM_LoadSteps(benchmark::State& state) {
  const Threads threads(static_cast<int>(state.range(1)));
  LoadStepOptions options;
  if (state.range(0) == 0) {
    options.schedule = LoadSchedule::kAdaptive;
  } else {
    options.steps = static_cast<int>(state.range(0));
  }
  int factorizations = 0;
  for (auto _ : state) factorizations = deform_elastically(breast(false), options).factorizations;
  state.counters["factorizations"] = factorizations;
  count_size(state, false);
}
BENCHMARK(BM_LoadSteps)
    ->ArgNames({"steps", "threads"})
    ->ArgsProduct({{1, 20, 0}, {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace crease::benchmarks
