// The Powell-Sabin spline: set-up and whole rasters, on one thread. Meshes are those of the triangular
// B-spline's benchmarks; `tables` binds by SparseRowGrid instead of the basis' own grid.
#include <benchmark/benchmark.h>

#include "Testing/Benchmarks/GridLoops.h"
#include "Transforms/Energies/BendingEnergy.h"
#include "Transforms/SparseRowGrid.h"
#include "Transforms/Splines/PowellSabinBasis.h"

namespace crease::benchmarks {
namespace {

/// Arguments: mesh, tables.
struct Setting {
  explicit Setting(const benchmark::State& state)
      : raster(raster_of<2>(state.range(0) == 2 ? std::array{2294, 1914} : std::array{512, 512})),
        tables(state.range(1) != 0) {
    constexpr std::array<int, 2> kCells[3] = {{8, 8}, {12, 12}, {18, 15}};
    mesh = jittered_net(raster, kCells[state.range(0)], 2, 0.3).mesh;
  }
  std::unique_ptr<BoundGrid<2>> bind(const PowellSabinBasis& basis) const {
    if (tables) return std::make_unique<SparseRowGrid<2>>(basis, raster);
    return basis.bind(raster);
  }
  void count_pixels(benchmark::State& state) const {
    count_time(state, "per_pixel", raster.num_samples());
  }
  Threads one_thread;
  Raster<2> raster;
  SimplexMesh<2> mesh;
  bool tables;
};

void own_only(benchmark::internal::Benchmark* b) {
  b->ArgNames({"mesh", "tables"})->ArgsProduct({{0, 1, 2}, {0}})->Unit(benchmark::kMillisecond);
}
void both(benchmark::internal::Benchmark* b) {
  b->ArgNames({"mesh", "tables"})->ArgsProduct({{0, 1, 2}, {0, 1}});
  b->Unit(benchmark::kMillisecond);
}

void BM_PowellSabinBasis(benchmark::State& state) {
  const Setting setting(state);
  for (auto _ : state) benchmark::DoNotOptimize(PowellSabinBasis(setting.mesh).degree());
  count_time(state, "per_triangle", setting.mesh.simplices.size());
}
BENCHMARK(BM_PowellSabinBasis)->Apply(own_only);

void BM_PowellSabinBending(benchmark::State& state) {
  const Setting setting(state);
  const PowellSabinBasis basis(setting.mesh);
  for (auto _ : state) benchmark::DoNotOptimize(BendingEnergy<2>(basis).matrix().nonZeros());
  count_time(state, "per_triangle", setting.mesh.simplices.size());
}
BENCHMARK(BM_PowellSabinBending)->Apply(own_only);

void BM_PowellSabinBind(benchmark::State& state) {
  const Setting setting(state);
  const PowellSabinBasis basis(setting.mesh);
  for (auto _ : state) benchmark::DoNotOptimize(setting.bind(basis));
  setting.count_pixels(state);
}
BENCHMARK(BM_PowellSabinBind)->Apply(both);

void BM_PowellSabinRasterMap(benchmark::State& state) {
  const Setting setting(state);
  const PowellSabinBasis basis(setting.mesh);
  time_raster_map(state, basis, *setting.bind(basis), setting.raster);
}
BENCHMARK(BM_PowellSabinRasterMap)->Apply(both);

void BM_PowellSabinAdjoint(benchmark::State& state) {
  const Setting setting(state);
  const PowellSabinBasis basis(setting.mesh);
  time_adjoint(state, basis, *setting.bind(basis), setting.raster);
}
BENCHMARK(BM_PowellSabinAdjoint)->Apply(both);

void BM_PowellSabinCurvature(benchmark::State& state) {
  const Setting setting(state);
  const PowellSabinBasis basis(setting.mesh);
  time_curvature(state, basis, *setting.bind(basis), setting.raster);
}
BENCHMARK(BM_PowellSabinCurvature)->Apply(both);

}  // namespace
}  // namespace crease::benchmarks
