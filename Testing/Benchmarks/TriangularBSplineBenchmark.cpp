// The triangular B-spline: points, set-up, and whole rasters; everything on one thread.
// Meshes are jittered grids of 8 x 8, 12 x 12 and 18 x 15 cells (128, 288 and 540 triangles), the last one
// on 2294 x 1914 pixels, the others on 512 x 512.
#include <benchmark/benchmark.h>

#include "Testing/Benchmarks/GridLoops.h"
#include "Transforms/SplineTransform.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"
#include "Transforms/Splines/TriangularBSplineGrid.h"

namespace crease::benchmarks {
namespace {

/// Arguments: mesh, degree, 100 alpha.
struct Setting {
  explicit Setting(const benchmark::State& state)
      : raster(raster_of<2>(state.range(0) == 2 ? std::array{2294, 1914} : std::array{512, 512})) {
    constexpr std::array<int, 2> kCells[3] = {{8, 8}, {12, 12}, {18, 15}};
    net = jittered_net(raster, kCells[state.range(0)], static_cast<int>(state.range(1)),
                       static_cast<double>(state.range(2)) / 100.0);
  }
  void count_pixels(benchmark::State& state) const {
    count_time(state, "per_pixel", raster.num_samples());
  }
  void count_triangles(benchmark::State& state) const {
    count_time(state, "per_triangle", net.mesh.simplices.size());
  }
  Threads one_thread;
  Raster<2> raster;
  KnotNet<2> net;
};

/// Scattered points in the cores, or outside them.
std::vector<Point<2>> points_in(const TriangularBSplineBasis<2>& basis, const Raster<2>& raster,
                                bool core) {
  std::vector<Point<2>> points = scattered_points(raster);
  std::erase_if(points,
                [&](const Point<2>& x) { return basis.in_core(basis.find_simplex(x), x) != core; });
  return points;
}

/// Values, and derivatives, of the functions that do not vanish.
void BM_TriangularPointBasis(benchmark::State& state) {
  const bool core = state.range(3) != 0;
  const int derivatives = static_cast<int>(state.range(4));
  const Setting setting(state);
  const TriangularBSplineBasis<2> basis(setting.net);
  const auto points = points_in(basis, setting.raster, core);
  for (auto _ : state) {
    for (const auto& x : points) benchmark::DoNotOptimize(basis.evaluate(x, derivatives));
  }
  count_time(state, "per_point", std::ssize(points));
  state.SetLabel(core ? "core" : "strip");
}
BENCHMARK(BM_TriangularPointBasis)
    ->ArgNames({"mesh", "degree", "alpha", "core", "derivatives"})
    ->ArgsProduct({{0}, {2, 3}, {30}, {0, 1}, {0, 1, 2}});

void BM_TriangularPointMap(benchmark::State& state) {
  const Setting setting(state);
  const auto basis = std::make_shared<TriangularBSplineBasis<2>>(setting.net);
  SplineTransform<2> transform(basis);
  transform.set_control_points(random_control_points(*basis));
  const auto points = scattered_points(setting.raster);
  for (auto _ : state) {
    for (const auto& x : points) benchmark::DoNotOptimize(transform.map(x));
  }
  count_time(state, "per_point", std::ssize(points));
}
BENCHMARK(BM_TriangularPointMap)
    ->ArgNames({"mesh", "degree", "alpha"})
    ->ArgsProduct({{0}, {2, 3}, {30}});

void all_meshes(benchmark::internal::Benchmark* b) {
  b->ArgNames({"mesh", "degree", "alpha"})->ArgsProduct({{0, 1, 2}, {3}, {30}});
  b->Unit(benchmark::kMillisecond);
}

void BM_TriangularBasis(benchmark::State& state) {
  const Setting setting(state);
  for (auto _ : state) {
    benchmark::DoNotOptimize(TriangularBSplineBasis<2>(setting.net).num_control_points());
  }
  setting.count_triangles(state);
}
BENCHMARK(BM_TriangularBasis)->Apply(all_meshes);

void BM_TriangularCouplings(benchmark::State& state) {
  const Setting setting(state);
  const TriangularBSplineBasis<2> basis(setting.net);
  for (auto _ : state) benchmark::DoNotOptimize(basis.couplings());
  setting.count_triangles(state);
}
BENCHMARK(BM_TriangularCouplings)->Apply(all_meshes);

// Bending: second derivatives, degree 2 (n - 2); rigidity: first derivatives, degree 4 (n - 1).
void BM_TriangularQuadrature(benchmark::State& state) {
  const Setting setting(state);
  const TriangularBSplineBasis<2> basis(setting.net);
  const bool bending = state.range(3) != 0;
  const int n = basis.degree();
  std::size_t cells = 0;
  for (auto _ : state) {
    cells = basis.quadrature(bending ? 2 * (n - 2) : 4 * (n - 1), bending ? 2 : 1).size();
  }
  setting.count_triangles(state);
  count_time(state, "per_cell", cells);
  state.SetLabel(bending ? "bending" : "rigidity");
}
BENCHMARK(BM_TriangularQuadrature)
    ->ArgNames({"mesh", "degree", "alpha", "bending"})
    ->ArgsProduct({{0, 1, 2}, {3}, {30}, {1}})
    ->Args({0, 3, 30, 0})
    ->Args({1, 3, 30, 0})
    ->Unit(benchmark::kMillisecond);

// The aim is 600 ns per strip pixel (degree 3, alpha 0.3).
void BM_TriangularBind(benchmark::State& state) {
  const Setting setting(state);
  const TriangularBSplineBasis<2> basis(setting.net);
  std::unique_ptr<BoundGrid<2>> grid;
  for (auto _ : state) grid = basis.bind(setting.raster);
  const auto& bound = dynamic_cast<const TriangularBSplineGrid&>(*grid);
  setting.count_pixels(state);
  count_time(state, "per_strip_pixel", bound.num_strip_samples());
  state.counters["strip_share"] = static_cast<double>(bound.num_strip_samples()) /
                                  static_cast<double>(setting.raster.num_samples());
}
BENCHMARK(BM_TriangularBind)
    ->ArgNames({"mesh", "degree", "alpha"})
    ->ArgsProduct({{0, 1, 2}, {2, 3}, {30, 50}})
    ->Unit(benchmark::kMillisecond);

void raster_cases(benchmark::internal::Benchmark* b) {
  b->ArgNames({"mesh", "degree", "alpha"})->ArgsProduct({{0, 1}, {2, 3}, {10, 30, 50}});
  b->Args({2, 3, 30})->Unit(benchmark::kMillisecond);
}

void BM_TriangularRasterMap(benchmark::State& state) {
  const Setting setting(state);
  const TriangularBSplineBasis<2> basis(setting.net);
  time_raster_map(state, basis, *basis.bind(setting.raster), setting.raster);
}
BENCHMARK(BM_TriangularRasterMap)->Apply(raster_cases);

void BM_TriangularAdjoint(benchmark::State& state) {
  const Setting setting(state);
  const TriangularBSplineBasis<2> basis(setting.net);
  time_adjoint(state, basis, *basis.bind(setting.raster), setting.raster);
}
BENCHMARK(BM_TriangularAdjoint)->Apply(raster_cases);

void BM_TriangularCurvature(benchmark::State& state) {
  const Setting setting(state);
  const TriangularBSplineBasis<2> basis(setting.net);
  time_curvature(state, basis, *basis.bind(setting.raster), setting.raster);
}
BENCHMARK(BM_TriangularCurvature)->Apply(all_meshes);

}  // namespace
}  // namespace crease::benchmarks
