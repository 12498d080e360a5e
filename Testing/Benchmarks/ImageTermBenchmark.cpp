// One pass over an image pair: SSD alone at points that are given, and metrics fused with the map and its
// adjoint for cubic splines with 625 control points.
#include "Registration/ImageTerm.h"

#include <benchmark/benchmark.h>

#include <vector>

#include "Images/MakeInterpolator.h"
#include "Metrics/MetricSum.h"
#include "Metrics/SumOfSquaredDifferences.h"
#include "Registration/MetricFactories.h"
#include "Registration/RowTiles.h"
#include "Testing/Benchmarks/Counters.h"
#include "Testing/Benchmarks/Samples.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease::benchmarks {
namespace {

/// Arguments: width, height, threads, then what a case adds.
std::array<int, 2> size_of(const benchmark::State& state) {
  return {static_cast<int>(state.range(0)), static_cast<int>(state.range(1))};
}

MetricInput<2> images_of(const std::array<int, 2>& size) {
  Image<float, 2> fixed = wavy_image<2>(size), moving = fixed;
  for (float& v : moving.values()) v *= 0.9f;
  std::vector<float> weights(fixed.values().size(), 1.0f);
  return {std::move(fixed), std::move(weights), make_interpolator(moving), nullptr};
}

std::unique_ptr<Metric<2>> ssd_of(const std::array<int, 2>& size) {
  return std::make_unique<SumOfSquaredDifferences<2>>(images_of(size));
}

void sizes(benchmark::internal::Benchmark* b, const char* argument,
           const std::vector<std::int64_t>& values) {
  b->ArgNames({"width", "height", "threads", argument});
  for (const auto value : values) {
    for (const int threads : {1, 2}) {
      b->Args({512, 512, threads, value})->Args({2294, 1914, threads, value});
    }
  }
  b->UseRealTime()->Unit(benchmark::kMillisecond);
}

/// Fourth argument: 0 value, 1 and force, 2 and curvature.
void BM_Ssd(benchmark::State& state) {
  const Threads threads(static_cast<int>(state.range(2)));
  const auto metric = ssd_of(size_of(state));
  const Raster<2>& raster = metric->fixed_raster();
  const std::vector<float> displacement(padded_row_size(raster), 1.3f);
  const RowTiles<2> tiles(raster);
  CurvatureBlocks<2> curvature(raster.size);
  for (auto _ : state) {
    std::vector<std::unique_ptr<Metric<2>::Sums>> sums(static_cast<std::size_t>(tiles.count()));
    parallel_for(tiles.count(), [&](std::int64_t tile) {
      auto& own = sums[static_cast<std::size_t>(tile)];
      own = metric->new_sums();
      std::array<std::vector<float>, 2> force = {displacement, displacement};
      tiles.for_each_row(tile, [&](std::int64_t r) {
        MappedRow<2> row;
        row.row = r;
        row.end = raster.size[0];
        row.start = raster.row_start(r);
        row.step = raster.index_to_point().col(0);
        row.displacement = {displacement.data(), displacement.data()};
        ForceRow<2> out;
        if (state.range(3) > 0) out.force = {force[0].data(), force[1].data()};
        if (state.range(3) > 1) {
          for (std::size_t k = 0; k < 3; ++k) {
            out.curvature[k] = curvature.sums[k].data() + curvature.row_offset(r, raster.size);
          }
        }
        metric->evaluate_row(0, row, out, *own);
      });
    });
    benchmark::DoNotOptimize(metric->finish_pass(0, sums));
  }
  count_time(state, "per_pixel", raster.num_samples(), threads.count());
}
BENCHMARK(BM_Ssd)->Apply([](auto* b) { sizes(b, "outputs", {0, 1, 2}); });

/// Fourth argument: 0 value; 1 value, force and adjoint: the gradient; 2 and the Gauss-Newton matrix.
void fused(benchmark::State& state, const SplineBasis<2>& basis,
           const std::shared_ptr<Metric<2>>& metric) {
  const Threads threads(static_cast<int>(state.range(2)));
  const Raster<2> raster = metric->fixed_raster();
  ImageTerm<2> term(basis.bind(raster), metric, {});
  const ControlPoints<2> phi = random_control_points(basis);
  ControlPoints<2> gradient = 0 * phi;
  BlockHessian<2> hessian(
      std::make_shared<HessianPattern>(basis.num_control_points(), basis.couplings()));
  for (auto _ : state) {
    benchmark::DoNotOptimize(term.evaluate(phi, 1, state.range(3) > 0 ? &gradient : nullptr,
                                           state.range(3) > 1 ? &hessian : nullptr));
  }
  count_time(state, "per_pixel", raster.num_samples(), threads.count());
}

void BM_FusedSsdTriangular(benchmark::State& state) {
  fused(state,
        TriangularBSplineBasis<2>(jittered_net(raster_of<2>(size_of(state)), {8, 8}, 3, 0.3)),
        ssd_of(size_of(state)));
}
BENCHMARK(BM_FusedSsdTriangular)->Apply([](auto* b) { sizes(b, "outputs", {0, 1, 2}); });

void BM_FusedSsdTensor(benchmark::State& state) {
  fused(state, *tensor_basis(raster_of<2>(size_of(state)), 22), ssd_of(size_of(state)));
}
BENCHMARK(BM_FusedSsdTensor)->Apply([](auto* b) { sizes(b, "outputs", {0, 1, 2}); });

/// The same images under every metric; fourth argument as above.
void fused_metric(benchmark::State& state, const MetricFactory<2>& metric) {
  fused(state, *tensor_basis(raster_of<2>(size_of(state)), 22), metric(images_of(size_of(state))));
}
void BM_FusedNcc(benchmark::State& state) { fused_metric(state, ncc<2>()); }
void BM_FusedLncc(benchmark::State& state) { fused_metric(state, local_ncc<2>()); }
void BM_FusedMi(benchmark::State& state) { fused_metric(state, mutual_information<2>()); }
void BM_FusedMiCubic(benchmark::State& state) {
  fused_metric(state, mutual_information<2>({.fixed_window = FixedWindow::kCubic}));
}
/// Two channels in one sweep: of squared differences, and with mutual information.
void BM_FusedTwoSsd(benchmark::State& state) {
  fused_metric(state, [](const MetricInput<2>& input) {
    return std::make_unique<MetricSum<2>>(
        std::vector<MetricSum<2>::Channel>{{ssd<2>()(input), 1}, {ssd<2>()(input), 0.5}});
  });
}
void BM_FusedSsdAndMi(benchmark::State& state) {
  fused_metric(state, [](const MetricInput<2>& input) {
    return std::make_unique<MetricSum<2>>(std::vector<MetricSum<2>::Channel>{
        {ssd<2>()(input), 1}, {mutual_information<2>()(input), 0.5}});
  });
}
BENCHMARK(BM_FusedTwoSsd)->Apply([](auto* b) { sizes(b, "outputs", {0, 1, 2}); });
BENCHMARK(BM_FusedSsdAndMi)->Apply([](auto* b) { sizes(b, "outputs", {0, 1, 2}); });
BENCHMARK(BM_FusedNcc)->Apply([](auto* b) { sizes(b, "outputs", {0, 1, 2}); });
BENCHMARK(BM_FusedLncc)->Apply([](auto* b) { sizes(b, "outputs", {0, 1, 2}); });
BENCHMARK(BM_FusedMi)->Apply([](auto* b) { sizes(b, "outputs", {0, 1, 2}); });
BENCHMARK(BM_FusedMiCubic)->Apply([](auto* b) { sizes(b, "outputs", {1}); });

}  // namespace
}  // namespace crease::benchmarks
