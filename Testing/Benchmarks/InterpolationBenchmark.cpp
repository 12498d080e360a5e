#include <benchmark/benchmark.h>

#include <cmath>

#include "Core/Parallel.h"
#include "Images/BSplinePrefilter.h"
#include "Images/IntensityRange.h"
#include "Images/MakeInterpolator.h"
#include "Images/Pyramid.h"
#include "Images/Smoothing.h"
#include "Testing/Benchmarks/Counters.h"
#include "Testing/Benchmarks/Samples.h"

namespace crease::benchmarks {
namespace {

Image<float, 2> image_for(const benchmark::State& state) {
  return wavy_image<2>({static_cast<int>(state.range(0)), static_cast<int>(state.range(1))});
}

/// A smooth displacement of a tenth of the width, and room for the results.
template <int Dim>
struct Field {
  explicit Field(const Raster<Dim>& r) : raster(r) {
    for (int a = 0; a < Dim; ++a) {
      displacement[a].resize(static_cast<std::size_t>(raster.num_samples()));
      gradient[a].resize(displacement[a].size());
      for (std::size_t p = 0; p < displacement[a].size(); ++p) {
        const double i = static_cast<double>(p) / raster.size[0];
        displacement[a][p] = static_cast<float>(
            0.05 * raster.size[0] * std::sin(0.01 * std::fmod(p, raster.size[0]) + 0.02 * i + a));
      }
    }
    value.resize(displacement[0].size());
    inside.resize(displacement[0].size());
  }
  void evaluate(const Interpolator<Dim>& moving, bool with_gradient) {
    constexpr std::int64_t kTile = 16;
    parallel_for((raster.num_rows() + kTile - 1) / kTile, [&](std::int64_t tile) {
      for (std::int64_t r = tile * kTile; r < std::min(raster.num_rows(), (tile + 1) * kTile);
           ++r) {
        const std::int64_t first = r * raster.size[0];
        MappedRow<Dim> row;
        row.end = raster.size[0];
        row.start = raster.row_start(r);
        row.step = raster.index_to_point().col(0);
        std::array<float*, Dim> out{};
        for (int a = 0; a < Dim; ++a) {
          row.displacement[a] = displacement[a].data() + first;
          if (with_gradient) out[a] = gradient[a].data() + first;
        }
        moving.evaluate_row(row, value.data() + first, out, inside.data() + first);
      }
    });
  }
  Raster<Dim> raster;
  std::array<std::vector<float>, Dim> displacement, gradient;
  std::vector<float> value, inside;
};

template <int Dim>
void interpolate(benchmark::State& state, const Image<float, Dim>& image, InterpolationKind kind,
                 bool with_gradient) {
  const Threads threads(static_cast<int>(state.range(2)));
  const auto moving = make_interpolator(image, kind);
  Field<Dim> field(image.raster());
  for (auto _ : state) {
    field.evaluate(*moving, with_gradient);
    benchmark::ClobberMemory();
  }
  count_time(state, "per_pixel", image.raster().num_samples(), threads.count());
}

void BM_CubicValueAndGradient(benchmark::State& state) {
  interpolate(state, image_for(state), InterpolationKind::kCubic, true);
}
void BM_CubicValue(benchmark::State& state) {
  interpolate(state, image_for(state), InterpolationKind::kCubic, false);
}
void BM_LinearValueAndGradient(benchmark::State& state) {
  interpolate(state, image_for(state), InterpolationKind::kLinear, true);
}
void BM_CubicValueAndGradient3D(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  interpolate(state, wavy_image<3>({n, n, static_cast<int>(state.range(1))}),
              InterpolationKind::kCubic, true);
}

template <typename Work>
void run(benchmark::State& state, Work&& work) {
  const Threads threads(static_cast<int>(state.range(2)));
  const auto image = image_for(state);
  for (auto _ : state) benchmark::DoNotOptimize(work(image));
  count_time(state, "per_pixel", image.raster().num_samples(), threads.count());
}

void BM_Prefilter(benchmark::State& state) {
  run(state, [](const Image<float, 2>& image) { return cubic_bspline_coefficients(image); });
}
void BM_Pyramid(benchmark::State& state) {
  run(state, [](const Image<float, 2>& image) { return make_pyramid(image, 4); });
}
void BM_Smooth121(benchmark::State& state) {
  run(state, [](const Image<float, 2>& image) { return smooth_121(image); });
}
void BM_GaussianSigma2(benchmark::State& state) {
  run(state, [](const Image<float, 2>& image) { return gaussian_smooth(image, 2.0); });
}
void BM_Percentiles(benchmark::State& state) {
  run(state, [](const Image<float, 2>& image) { return intensity_percentiles(image); });
}

void sizes_and_threads(benchmark::internal::Benchmark* b) {
  b->ArgNames({"width", "height", "threads"})->UseRealTime();
  for (int threads : {1, 2}) b->Args({512, 512, threads})->Args({2294, 1914, threads});
}

BENCHMARK(BM_CubicValueAndGradient)->Apply(sizes_and_threads);
BENCHMARK(BM_CubicValue)->Apply(sizes_and_threads);
BENCHMARK(BM_LinearValueAndGradient)->Apply(sizes_and_threads);
BENCHMARK(BM_CubicValueAndGradient3D)
    ->ArgNames({"width", "depth", "threads"})
    ->Args({128, 64, 1})
    ->Args({128, 64, 2})
    ->UseRealTime();
BENCHMARK(BM_Prefilter)->Apply(sizes_and_threads);
BENCHMARK(BM_Pyramid)->Apply(sizes_and_threads);
BENCHMARK(BM_Smooth121)->Apply(sizes_and_threads);
BENCHMARK(BM_GaussianSigma2)->Apply(sizes_and_threads);
BENCHMARK(BM_Percentiles)->Apply(sizes_and_threads);

}  // namespace
}  // namespace crease::benchmarks
