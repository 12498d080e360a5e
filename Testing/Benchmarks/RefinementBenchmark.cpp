// Refining by intensities a breast that was deformed before: half an ellipse of 125 x 190 mm in an image of
// 2294 x 1914 pixels of 0.094 mm or by 2, 4, 8, with a stiff corner behind a crease; quadratic splines on 600
// triangles.
#include <benchmark/benchmark.h>

#include <map>
#include <numbers>

#include "Images/Resample.h"
#include "Metrics/SumOfSquaredDifferences.h"
#include "Registration/CreasedDomain.h"
#include "Registration/Elastic/BodyOutline.h"
#include "Registration/Elastic/DisplacementSamples.h"
#include "Registration/Elastic/ImageRefinement.h"
#include "Registration/ImageTerm.h"
#include "Registration/Phantoms/PowerLawTexture.h"
#include "Registration/SamplesInside.h"
#include "Testing/Benchmarks/Counters.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/Energies/LinearElasticEnergy.h"
#include "Transforms/TransformSampler.h"

namespace crease::benchmarks {
namespace {

constexpr double kPixel = 0.094;  // mm

Raster<2> breast_raster(int shrink) {
  Raster<2> raster;
  raster.size = {1914 / shrink, 2294 / shrink};
  raster.spacing.setConstant(kPixel * shrink);
  return raster;
}

/// Chest wall at the left.
RegionOfInterest breast() {
  Polyline outline;
  constexpr int kPoints = 48;
  for (int i = 0; i <= kPoints; ++i) {
    const double t = (static_cast<double>(i) / kPoints - 0.5) * std::numbers::pi;
    outline.push_back({2 + 125 * std::cos(t), 108 + 95 * std::sin(t)});
  }
  return RegionOfInterest({outline});
}

const CreasedDomain& domain() {
  static const CreasedDomain made = [] {
    const auto region = breast();
    const FeatureLine muscle =
        outline_beyond({{50, 5}, {2, 75}}, region.bounds(), {0, 0}, 1, "muscle");
    return make_creased_domain(region, {muscle},
                               {.degree = 2, .num_triangles = 600, .rigid_bodies = false});
  }();
  return made;
}

/// Two waves across the breast: `size` mm.
SplineTransform<2> wave(double size, double phase) {
  SplineTransform<2> transform(domain().basis);
  const ControlPoints<2> places = domain().basis->greville_points();
  ControlPoints<2> phi(2, places.cols());
  for (Eigen::Index i = 0; i < phi.cols(); ++i) {
    const double x = places(0, i) / 127, y = places(1, i) / 216;
    phi.col(i) =
        size * x * Vector<2>(std::sin(2 * std::numbers::pi * y + phase), std::cos(3 * x + phase));
  }
  transform.set_control_points(phi);
  return transform;
}

/// Images of a resolution and the map that is to be refined.
struct Scene {
  explicit Scene(int shrink) : start(wave(6, 0.3)) {
    const Raster<2> raster = breast_raster(shrink);
    const PowerLawTexture<2> texture(1024, 1.5, 1, Random(7, 0));
    moving = Image<float, 2>(raster);
    parallel_for(raster.size[1], [&](std::int64_t j) {
      for (int i = 0; i < raster.size[0]; ++i) {
        const Point<2> x = raster.point({i, static_cast<double>(j)});
        moving(i, static_cast<int>(j)) = static_cast<float>(texture(x / (4 * kPixel)));
      }
    });
    const auto v = wave(0.5, 1.7);
    const PointMap<2> truth = [&](const Point<2>& x) { return start.map(v.map(x)); };
    fixed = resample(*make_interpolator(moving), raster, truth);
    options.material.tissue = {1000, 0.495};
    options.material.regions[1] = {10000, 0.495};
    options.pins = chest_wall_ends(breast());
  }
  Image<float, 2> fixed, moving;
  SplineTransform<2> start;
  ImageRefinementOptions options;
};

const Scene& scene(int shrink) {
  static std::map<int, Scene> made;
  return made.try_emplace(shrink, shrink).first->second;
}

MetricInput<2> input_of(const Scene& s, const BoundGrid<2>& grid, bool composed) {
  MetricInput<2> input;
  input.fixed = s.fixed;
  input.weights.assign(s.fixed.values().size(), 1.0f);
  keep_samples_in_domain(grid, input.weights);
  keep_samples_inside<2>(grid, {}, s.start.control_points(), s.moving.raster(), 1, input.weights);
  input.moving = make_interpolator(s.moving);
  if (composed) {
    input.moving = std::make_shared<DisplacedInterpolator<2>>(
        input.moving, sample_displacement(s.start, grid).components);
  }
  return input;
}

/// Arguments: shrink, threads; 0 value, 1 and gradient, 2 and the Gauss-Newton matrix; composed or not.
void BM_RefinementPass(benchmark::State& state) {
  const Threads threads(static_cast<int>(state.range(1)));
  const Scene& s = scene(static_cast<int>(state.range(0)));
  std::shared_ptr<const BoundGrid<2>> grid = domain().basis->bind(s.fixed.raster());
  ImageTerm<2> term(
      grid, std::make_shared<SumOfSquaredDifferences<2>>(input_of(s, *grid, state.range(3) > 0)),
      {});
  const ControlPoints<2> phi = wave(0.3, 0.9).control_points();
  ControlPoints<2> gradient = 0 * phi;
  BlockHessian<2> hessian(domain().basis->pattern());
  for (auto _ : state) {
    benchmark::DoNotOptimize(term.evaluate(phi, 1, state.range(2) > 0 ? &gradient : nullptr,
                                           state.range(2) > 1 ? &hessian : nullptr));
  }
  count_time(state, "per_pixel", s.fixed.raster().num_samples(), threads.count());
}
BENCHMARK(BM_RefinementPass)
    ->ArgNames({"shrink", "threads", "outputs", "composed"})
    ->ArgsProduct({{8, 1}, {1, 2}, {0, 1, 2}, {0, 1}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// The composite map and its derivative at every pixel, inside the breast and beyond. Arguments: sampler (0: one
/// point after the other), threads.
void BM_MapAtAllPixels(benchmark::State& state) {
  const Threads threads(static_cast<int>(state.range(1)));
  std::vector<std::unique_ptr<Transform<2>>> parts;
  parts.push_back(wave(0.3, 0.9).clone());
  parts.push_back(wave(6, 0.3).clone());
  const CompositeTransform<2> map(std::move(parts));
  const Raster<2> raster = breast_raster(1);
  for (auto _ : state) {
    const std::unique_ptr<const TransformSampler<2>> sampler =
        state.range(0) > 0 ? map.sampler() : std::make_unique<OneByOneSampler<2>>(map);
    parallel_for(raster.size[1], [&](std::int64_t row) {
      std::vector<Point<2>> x;
      for (int i = 0; i < raster.size[0]; ++i) {
        x.push_back(raster.point({i, static_cast<double>(row)}));
      }
      std::vector<Transform<2>::Sample> samples(x.size());
      sampler->sample(x, samples);
      benchmark::DoNotOptimize(samples.data());
    });
  }
  count_time(state, "per_pixel", raster.num_samples(), threads.count());
}
BENCHMARK(BM_MapAtAllPixels)
    ->ArgNames({"sampler", "threads"})
    ->ArgsProduct({{0, 1}, {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// Arguments: shrink, threads.
void BM_RefinementSetUp(benchmark::State& state) {
  const Threads threads(static_cast<int>(state.range(1)));
  const Scene& s = scene(static_cast<int>(state.range(0)));
  std::shared_ptr<const BoundGrid<2>> grid = domain().basis->bind(s.fixed.raster());
  int step = 0;
  for (auto _ : state) {
    const DisplacementSamples samples = sample_displacement(s.start, *grid);
    step = samples.step;
  }
  state.counters["step"] = step;
}
BENCHMARK(BM_RefinementSetUp)
    ->ArgNames({"shrink", "threads"})
    ->ArgsProduct({{8, 1}, {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void BM_LinearElasticEnergy(benchmark::State& state) {
  const Threads threads(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(LinearElasticEnergy<2>(*domain().basis, scene(8).options.material));
  }
}
BENCHMARK(BM_LinearElasticEnergy)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// The whole refinement at a resolution alone, as in the dissertation's table 4.1. Arguments: shrink, threads,
/// 0 Gauss-Newton, 1 damped.
void BM_Refinement(benchmark::State& state) {
  const Threads threads(static_cast<int>(state.range(1)));
  const Scene& s = scene(static_cast<int>(state.range(0)));
  ImageRefinementOptions options = s.options;
  options.levels = 1;
  options.smoothing_mm = {0.75};
  if (state.range(2) > 0) options.method = RefinementMethod::kDamped;
  RefinementLevel level;
  for (auto _ : state) {
    level = refine_by_images(s.fixed, s.moving, nullptr, s.start, options).levels.front();
  }
  state.counters["iterations"] = level.iterations;
  state.counters["ms_per_iteration"] = 1e3 * level.iterations_s / std::max(1, level.iterations);
  state.counters["setup_ms"] = 1e3 * level.setup_s;
}
BENCHMARK(BM_Refinement)
    ->ArgNames({"shrink", "threads", "damped"})
    ->ArgsProduct({{8, 4, 2, 1}, {1, 2}, {0, 1}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace crease::benchmarks
