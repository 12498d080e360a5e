// The triangular B-spline: points, set-up, and whole rasters; everything on one thread.
// Meshes are jittered grids of 8 x 8, 12 x 12 and 18 x 15 cells (128, 288 and 540 triangles).
#include <benchmark/benchmark.h>

#include <random>

#include "Core/Parallel.h"
#include "Transforms/BoundGrid.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Domains/StructuredTriangulation.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace {

using namespace crease;

struct Setting {
  std::array<int, 2> pixels;
  std::array<int, 2> cells;
  int degree = 3;
  double alpha = 0.3;
};

Setting setting_of(const benchmark::State& state) {
  constexpr std::array<int, 2> kCells[3] = {{8, 8}, {12, 12}, {18, 15}};
  const bool large = state.range(0) == 2;
  return {large ? std::array{2294, 1914} : std::array{512, 512}, kCells[state.range(0)],
          static_cast<int>(state.range(1)), static_cast<double>(state.range(2)) / 100.0};
}

Raster<2> raster_of(const Setting& setting) {
  Raster<2> raster;
  raster.size = setting.pixels;
  return raster;
}

KnotNet<2> net_of(const Setting& setting) {
  const Raster<2> raster = raster_of(setting);
  DomainMesh domain;
  domain.mesh = structured_triangulation(raster.bounds(), setting.cells[0], setting.cells[1],
                                         Diagonals::rising);
  const Vector<2> cell =
      raster.bounds().size().cwiseQuotient(Vector<2>(setting.cells[0], setting.cells[1]));
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(-0.2, 0.2);
  for (auto& v : domain.mesh.vertices) {
    const Vector<2> shift(uniform(engine) * cell.x(), uniform(engine) * cell.y());
    const Box<2> box = raster.bounds();
    const bool inner = (v - box.lower).minCoeff() > 1.0 && (box.upper - v).minCoeff() > 1.0;
    if (inner) v += shift;
  }
  KnotOptions options;
  options.degree = setting.degree;
  options.alpha = setting.alpha;
  return place_knots(domain, options).net;
}

// Points in the cores, or outside them.
std::vector<Point<2>> scattered_points(const TriangularBSplineBasis<2>& basis, bool core) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(0, 511);
  std::vector<Point<2>> points;
  while (points.size() < 1024) {
    const Point<2> x(uniform(engine), uniform(engine));
    if (basis.in_core(basis.find_simplex(x), x) == core) points.push_back(x);
  }
  return points;
}

void BM_TriangularPoint(benchmark::State& state) {
  const bool core = state.range(3) != 0;
  const int derivatives = static_cast<int>(state.range(4));
  const TriangularBSplineBasis<2> basis(net_of(setting_of(state)));
  const auto points = scattered_points(basis, core);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(basis.evaluate(points[i++ % points.size()], derivatives));
  }
  state.SetLabel(core ? "core" : "strip");
}
BENCHMARK(BM_TriangularPoint)
    ->ArgNames({"mesh", "degree", "alpha", "core", "derivatives"})
    ->ArgsProduct({{0}, {2, 3}, {30}, {0, 1}, {0, 1, 2}});

void BM_TriangularBasis(benchmark::State& state) {
  set_num_threads(1);
  const auto net = net_of(setting_of(state));
  for (auto _ : state)
    benchmark::DoNotOptimize(TriangularBSplineBasis<2>(net).num_control_points());
  set_num_threads(0);
}
BENCHMARK(BM_TriangularBasis)
    ->ArgNames({"mesh", "degree", "alpha"})
    ->ArgsProduct({{0, 1, 2}, {3}, {30}})
    ->Unit(benchmark::kMillisecond);

void BM_TriangularCouplings(benchmark::State& state) {
  set_num_threads(1);
  const TriangularBSplineBasis<2> basis(net_of(setting_of(state)));
  for (auto _ : state) benchmark::DoNotOptimize(basis.couplings());
  set_num_threads(0);
}
BENCHMARK(BM_TriangularCouplings)
    ->ArgNames({"mesh", "degree", "alpha"})
    ->ArgsProduct({{0, 1, 2}, {3}, {30}})
    ->Unit(benchmark::kMillisecond);

// Bending: second derivatives, degree 2 (n - 2); rigidity: first derivatives, degree 4 (n - 1).
void BM_TriangularQuadrature(benchmark::State& state) {
  set_num_threads(1);
  const TriangularBSplineBasis<2> basis(net_of(setting_of(state)));
  const bool bending = state.range(3) != 0;
  const int n = basis.degree();
  std::size_t cells = 0;
  for (auto _ : state) {
    cells = basis.quadrature(bending ? 2 * (n - 2) : 4 * (n - 1), bending ? 2 : 1).size();
  }
  state.counters["cells"] = static_cast<double>(cells);
  state.SetLabel(bending ? "bending" : "rigidity");
  set_num_threads(0);
}
BENCHMARK(BM_TriangularQuadrature)
    ->ArgNames({"mesh", "degree", "alpha", "bending"})
    ->ArgsProduct({{0, 1, 2}, {3}, {30}, {1}})
    ->Args({0, 3, 30, 0})
    ->Args({1, 3, 30, 0})
    ->Unit(benchmark::kMillisecond);

void BM_TriangularBind(benchmark::State& state) {
  set_num_threads(1);
  const Setting setting = setting_of(state);
  const TriangularBSplineBasis<2> basis(net_of(setting));
  for (auto _ : state) benchmark::DoNotOptimize(basis.bind(raster_of(setting)));
  state.SetItemsProcessed(state.iterations() * raster_of(setting).num_samples());
  set_num_threads(0);
}
BENCHMARK(BM_TriangularBind)
    ->ArgNames({"mesh", "degree", "alpha"})
    ->ArgsProduct({{0, 1, 2}, {2, 3}, {30, 50}})
    ->Unit(benchmark::kMillisecond);

ControlPoints<2> random_control_points(const SplineBasis<2>& basis) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(-3, 3);
  return ControlPoints<2>::NullaryExpr(2, basis.num_control_points(),
                                       [&] { return uniform(engine); });
}

// Items are samples: the time per item is that of one pixel of a 2-vector.
void BM_TriangularMap(benchmark::State& state) {
  const Setting setting = setting_of(state);
  const TriangularBSplineBasis<2> basis(net_of(setting));
  const auto grid = basis.bind(raster_of(setting));
  const auto points = random_control_points(basis);
  std::vector<float> x(padded_row_size(grid->raster())), y = x;
  for (auto _ : state) {
    const auto coefficients = grid->prepare(points);
    for (std::int64_t r = 0; r < grid->raster().num_rows(); ++r) {
      grid->map_row(*coefficients, r, {x.data(), y.data()});
      benchmark::DoNotOptimize(x.data());
    }
  }
  state.SetItemsProcessed(state.iterations() * grid->raster().num_samples());
}
BENCHMARK(BM_TriangularMap)
    ->ArgNames({"mesh", "degree", "alpha"})
    ->ArgsProduct({{0, 1}, {2, 3}, {10, 30, 50}})
    ->Args({2, 3, 30})
    ->Unit(benchmark::kMillisecond);

void BM_TriangularAdjoint(benchmark::State& state) {
  const Setting setting = setting_of(state);
  const TriangularBSplineBasis<2> basis(net_of(setting));
  const auto grid = basis.bind(raster_of(setting));
  const std::vector<float> x(padded_row_size(grid->raster()), 0.7f);
  ControlPoints<2> gradient = ControlPoints<2>::Zero(2, basis.num_control_points());
  for (auto _ : state) {
    std::vector<std::unique_ptr<BoundGrid<2>::Accumulator>> sums;
    for (std::int64_t r = 0; r < grid->raster().num_rows(); ++r) {
      if (r % 16 == 0) sums.push_back(grid->new_accumulator());
      grid->add_row(*sums.back(), r, {x.data(), x.data()});
    }
    grid->finish(sums, gradient);
    benchmark::DoNotOptimize(gradient.data());
  }
  state.SetItemsProcessed(state.iterations() * grid->raster().num_samples());
}
BENCHMARK(BM_TriangularAdjoint)
    ->ArgNames({"mesh", "degree", "alpha"})
    ->ArgsProduct({{0, 1}, {2, 3}, {10, 30, 50}})
    ->Args({2, 3, 30})
    ->Unit(benchmark::kMillisecond);

void BM_TriangularCurvature(benchmark::State& state) {
  set_num_threads(1);
  const Setting setting = setting_of(state);
  const TriangularBSplineBasis<2> basis(net_of(setting));
  const auto grid = basis.bind(raster_of(setting));
  CurvatureBlocks<2> blocks(setting.pixels);
  for (auto& sums : blocks.sums) std::fill(sums.begin(), sums.end(), 0.5f);
  BlockHessian<2> hessian(
      std::make_shared<HessianPattern>(basis.num_control_points(), basis.couplings()));
  for (auto _ : state) {
    grid->add_curvature(blocks, 1.0, hessian);
    benchmark::DoNotOptimize(&hessian);
  }
  set_num_threads(0);
}
BENCHMARK(BM_TriangularCurvature)
    ->ArgNames({"mesh", "degree", "alpha"})
    ->ArgsProduct({{0, 1, 2}, {3}, {30}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
