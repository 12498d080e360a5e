// Energies of a deformation: set-up once, then value, gradient and Hessian as an optimizer asks for
// them. All on one thread.
#include <benchmark/benchmark.h>

#include "Testing/Benchmarks/Counters.h"
#include "Testing/Benchmarks/Samples.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Domains/StructuredTriangulation.h"
#include "Transforms/Energies/BendingEnergy.h"
#include "Transforms/Energies/RigidityEnergy.h"
#include "Transforms/Splines/TensorBSplineBasis.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease::benchmarks {
namespace {

template <int Dim>
std::shared_ptr<const TensorBSplineBasis<Dim>> box_basis(const benchmark::State& state) {
  TensorLattice<Dim> lattice;
  lattice.spans.fill(static_cast<int>(state.range(0)));
  return std::make_shared<TensorBSplineBasis<Dim>>(lattice);
}

template <int Dim>
std::shared_ptr<const HessianPattern> pattern_of(const SplineBasis<Dim>& basis) {
  return std::make_shared<HessianPattern>(basis.num_control_points(), basis.couplings());
}

/// Spans of a tensor-product spline, triangles of a triangular one.
template <int Dim>
void count_patches(benchmark::State& state, const TensorBSplineBasis<Dim>& basis) {
  std::int64_t spans = 1;
  for (int s : basis.lattice().spans) spans *= s;
  count_time(state, "per_patch", spans);
}
void count_patches(benchmark::State& state, const TriangularBSplineBasis<2>& basis) {
  count_time(state, "per_patch", basis.net().mesh.simplices.size());
}

/// A disc or ball in the middle that is rigid.
template <int Dim>
WeightField<Dim> ball(const SplineBasis<Dim>& basis) {
  const Point<Dim> centre = 0.5 * (basis.bounds().lower + basis.bounds().upper);
  const double radius = 0.3 * basis.bounds().size().minCoeff();
  return [=](const Point<Dim>& x, int) { return (x - centre).norm() < radius ? 1.0 : 0.0; };
}

template <int Dim>
void BM_Pattern(benchmark::State& state) {
  const Threads one_thread;
  const auto basis = box_basis<Dim>(state);
  for (auto _ : state) benchmark::DoNotOptimize(pattern_of<Dim>(*basis));
  count_patches(state, *basis);
}
BENCHMARK(BM_Pattern<2>)->Arg(22)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Pattern<3>)->Arg(12)->Unit(benchmark::kMillisecond);

template <int Dim>
void BM_BendingAssembly(benchmark::State& state) {
  const Threads one_thread;
  const auto basis = box_basis<Dim>(state);
  for (auto _ : state) benchmark::DoNotOptimize(BendingEnergy<Dim>(*basis));
  count_patches(state, *basis);
}
BENCHMARK(BM_BendingAssembly<2>)->Arg(22)->Arg(64)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_BendingAssembly<3>)->Arg(12)->Unit(benchmark::kMillisecond);

template <int Dim>
void BM_BendingAssemblyWithBody(benchmark::State& state) {
  const Threads one_thread;
  const auto basis = box_basis<Dim>(state);
  const auto weights = ball<Dim>(*basis);
  for (auto _ : state) benchmark::DoNotOptimize(BendingEnergy<Dim>(*basis, weights));
  count_patches(state, *basis);
}
BENCHMARK(BM_BendingAssemblyWithBody<2>)->Arg(22)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_BendingAssemblyWithBody<3>)->Arg(12)->Unit(benchmark::kMillisecond);

template <int Dim>
void BM_BendingEvaluate(benchmark::State& state) {
  const Threads one_thread;
  const auto basis = box_basis<Dim>(state);
  const BendingEnergy<Dim> energy(*basis);
  const auto phi = random_control_points<Dim>(*basis, 0.3);
  ControlPoints<Dim> gradient = 0 * phi;
  BlockHessian<Dim> hessian(pattern_of<Dim>(*basis));
  for (auto _ : state) benchmark::DoNotOptimize(energy.evaluate(phi, 1, &gradient, &hessian));
  count_patches(state, *basis);
}
BENCHMARK(BM_BendingEvaluate<2>)->Arg(22)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_BendingEvaluate<3>)->Arg(12)->Unit(benchmark::kMillisecond);

template <int Dim>
void BM_RigidityAssembly(benchmark::State& state) {
  const Threads one_thread;
  const auto basis = box_basis<Dim>(state);
  const auto weights = ball<Dim>(*basis);
  for (auto _ : state) benchmark::DoNotOptimize(RigidityEnergy<Dim>(*basis, weights));
  count_patches(state, *basis);
}
BENCHMARK(BM_RigidityAssembly<2>)->Arg(22)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_RigidityAssembly<3>)->Arg(12)->Unit(benchmark::kMillisecond);

/// Second argument: 0 value, 1 value and gradient, 2 with the Hessian.
template <int Dim>
void BM_RigidityEvaluate(benchmark::State& state) {
  const Threads one_thread;
  const auto basis = box_basis<Dim>(state);
  const RigidityEnergy<Dim> energy(*basis, ball<Dim>(*basis));
  const auto phi = random_control_points<Dim>(*basis, 0.3);
  ControlPoints<Dim> gradient = 0 * phi;
  BlockHessian<Dim> hessian(pattern_of<Dim>(*basis));
  const bool with_gradient = state.range(1) > 0, with_hessian = state.range(1) > 1;
  for (auto _ : state) {
    benchmark::DoNotOptimize(energy.evaluate(phi, 1, with_gradient ? &gradient : nullptr,
                                             with_hessian ? &hessian : nullptr));
  }
  count_patches(state, *basis);
}
BENCHMARK(BM_RigidityEvaluate<2>)->ArgsProduct({{22}, {0, 1, 2}})->Unit(benchmark::kMillisecond);
BENCHMARK(BM_RigidityEvaluate<3>)->ArgsProduct({{12}, {0, 1, 2}})->Unit(benchmark::kMillisecond);

/// Cubic, 2 n^2 triangles, general knots or all knots at the vertices.
std::unique_ptr<TriangularBSplineBasis<2>> triangular_basis(int n, bool collapsed) {
  Box<2> box;
  box.add({0, 0});
  box.add({double(n), double(n)});
  DomainMesh domain{structured_triangulation(box, n, n), {}, {}, {}};
  domain.mesh.regions.assign(domain.mesh.simplices.size(), 1);
  KnotOptions options;
  options.alpha = 0.3;
  options.collapse_inside_bodies = collapsed;
  return std::make_unique<TriangularBSplineBasis<2>>(place_knots(domain, options).net);
}

/// Arguments: cells per side, knots of the body collapsed.
void BM_TriangularBendingAssembly(benchmark::State& state) {
  const Threads one_thread;
  const auto basis = triangular_basis(static_cast<int>(state.range(0)), false);
  for (auto _ : state) benchmark::DoNotOptimize(BendingEnergy<2>(*basis));
  count_patches(state, *basis);
}
BENCHMARK(BM_TriangularBendingAssembly)->Arg(8)->Arg(12)->Unit(benchmark::kMillisecond);

void BM_TriangularRigidityAssembly(benchmark::State& state) {
  const Threads one_thread;
  const auto basis = triangular_basis(static_cast<int>(state.range(0)), state.range(1) != 0);
  for (auto _ : state) benchmark::DoNotOptimize(RigidityEnergy<2>(*basis));
  count_patches(state, *basis);
}
BENCHMARK(BM_TriangularRigidityAssembly)->ArgsProduct({{8}, {0, 1}})->Unit(benchmark::kMillisecond);

/// Third argument: 0 value, 1 value and gradient, 2 with the Hessian.
void BM_TriangularRigidityEvaluate(benchmark::State& state) {
  const Threads one_thread;
  const auto basis = triangular_basis(static_cast<int>(state.range(0)), state.range(1) != 0);
  const RigidityEnergy<2> energy(*basis);
  const auto phi = random_control_points<2>(*basis, 0.3);
  ControlPoints<2> gradient = 0 * phi;
  BlockHessian<2> hessian(pattern_of<2>(*basis));
  for (auto _ : state) {
    benchmark::DoNotOptimize(energy.evaluate(phi, 1, state.range(2) > 0 ? &gradient : nullptr,
                                             state.range(2) > 1 ? &hessian : nullptr));
  }
  count_patches(state, *basis);
}
BENCHMARK(BM_TriangularRigidityEvaluate)
    ->ArgsProduct({{8}, {0, 1}, {0, 1, 2}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace crease::benchmarks
