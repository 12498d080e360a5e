#pragma once

#include <benchmark/benchmark.h>

#include "Testing/Benchmarks/Counters.h"
#include "Testing/Benchmarks/Samples.h"
#include "Transforms/BoundGrid.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease::benchmarks {

// Whole rasters through a bound grid; each counts the time per pixel.

inline void time_raster_map(benchmark::State& state, const SplineBasis<2>& basis,
                            const BoundGrid<2>& grid, const Raster<2>& raster) {
  const auto points = random_control_points(basis);
  std::vector<float> x(padded_row_size(raster)), y = x;
  for (auto _ : state) {
    const auto coefficients = grid.prepare(points);
    for (std::int64_t r = 0; r < raster.num_rows(); ++r) {
      grid.map_row(*coefficients, r, {x.data(), y.data()});
      benchmark::DoNotOptimize(x.data());
    }
  }
  count_time(state, "per_pixel", raster.num_samples());
}

inline void time_adjoint(benchmark::State& state, const SplineBasis<2>& basis,
                         const BoundGrid<2>& grid, const Raster<2>& raster) {
  const std::vector<float> x(padded_row_size(raster), 0.7f);
  ControlPoints<2> gradient = ControlPoints<2>::Zero(2, basis.num_control_points());
  for (auto _ : state) {
    std::vector<std::unique_ptr<BoundGrid<2>::Accumulator>> sums;
    for (std::int64_t r = 0; r < raster.num_rows(); ++r) {
      if (r % 16 == 0) sums.push_back(grid.new_accumulator());
      grid.add_row(*sums.back(), r, {x.data(), x.data()});
    }
    grid.finish(sums, gradient);
    benchmark::DoNotOptimize(gradient.data());
  }
  count_time(state, "per_pixel", raster.num_samples());
}

inline void time_curvature(benchmark::State& state, const SplineBasis<2>& basis,
                           const BoundGrid<2>& grid, const Raster<2>& raster) {
  CurvatureBlocks<2> blocks(raster.size);
  for (auto& sums : blocks.sums) std::fill(sums.begin(), sums.end(), 0.5f);
  BlockHessian<2> hessian(basis.pattern());
  for (auto _ : state) {
    grid.add_curvature(blocks, 1.0, hessian);
    benchmark::DoNotOptimize(&hessian);
  }
  count_time(state, "per_pixel", raster.num_samples());
}

}  // namespace crease::benchmarks
