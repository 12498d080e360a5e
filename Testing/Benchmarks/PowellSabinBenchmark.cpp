// The Powell-Sabin spline: set-up and whole rasters, on one thread. Meshes are those of the triangular
// B-spline's benchmarks; `tables` binds by SparseRowGrid instead of the basis' own grid.
#include <benchmark/benchmark.h>

#include "Testing/Benchmarks/Counters.h"
#include "Testing/Benchmarks/Samples.h"
#include "Transforms/BoundGrid.h"
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
  const auto grid = setting.bind(basis);
  const auto points = random_control_points(basis);
  std::vector<float> x(padded_row_size(setting.raster)), y = x;
  for (auto _ : state) {
    const auto coefficients = grid->prepare(points);
    for (std::int64_t r = 0; r < setting.raster.num_rows(); ++r) {
      grid->map_row(*coefficients, r, {x.data(), y.data()});
      benchmark::DoNotOptimize(x.data());
    }
  }
  setting.count_pixels(state);
}
BENCHMARK(BM_PowellSabinRasterMap)->Apply(both);

void BM_PowellSabinAdjoint(benchmark::State& state) {
  const Setting setting(state);
  const PowellSabinBasis basis(setting.mesh);
  const auto grid = setting.bind(basis);
  const std::vector<float> x(padded_row_size(setting.raster), 0.7f);
  ControlPoints<2> gradient = ControlPoints<2>::Zero(2, basis.num_control_points());
  for (auto _ : state) {
    std::vector<std::unique_ptr<BoundGrid<2>::Accumulator>> sums;
    for (std::int64_t r = 0; r < setting.raster.num_rows(); ++r) {
      if (r % 16 == 0) sums.push_back(grid->new_accumulator());
      grid->add_row(*sums.back(), r, {x.data(), x.data()});
    }
    grid->finish(sums, gradient);
    benchmark::DoNotOptimize(gradient.data());
  }
  setting.count_pixels(state);
}
BENCHMARK(BM_PowellSabinAdjoint)->Apply(both);

void BM_PowellSabinCurvature(benchmark::State& state) {
  const Setting setting(state);
  const PowellSabinBasis basis(setting.mesh);
  const auto grid = setting.bind(basis);
  CurvatureBlocks<2> blocks(setting.raster.size);
  for (auto& sums : blocks.sums) std::fill(sums.begin(), sums.end(), 0.5f);
  BlockHessian<2> hessian(
      std::make_shared<HessianPattern>(basis.num_control_points(), basis.couplings()));
  for (auto _ : state) {
    grid->add_curvature(blocks, 1.0, hessian);
    benchmark::DoNotOptimize(&hessian);
  }
  setting.count_pixels(state);
}
BENCHMARK(BM_PowellSabinCurvature)->Apply(both);

}  // namespace
}  // namespace crease::benchmarks
