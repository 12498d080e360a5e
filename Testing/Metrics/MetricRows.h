#pragma once

#include <array>
#include <memory>
#include <vector>

#include "Metrics/Metric.h"

namespace crease::testing {

/// What the row interface of a metric yields for a displacement of the samples, whole raster.
template <int Dim>
struct RowResult {
  double value = 0;
  std::vector<Vector<Dim>> forces;
  std::vector<double> curvature_trace;  // per row, summed
};

template <int Dim>
RowResult<Dim> by_rows(Metric<Dim>& metric, const std::vector<Point<Dim>>& mapped) {
  const auto& raster = metric.fixed_raster();
  const auto width = static_cast<std::size_t>(raster.size[0]);
  RowResult<Dim> result;
  for (int pass = 0; pass < metric.num_passes(); ++pass) {
    result.forces.clear();
    result.curvature_trace.clear();
    std::vector<std::unique_ptr<typename Metric<Dim>::Sums>> sums;
    for (std::int64_t r = 0; r < raster.num_rows(); ++r) {
      std::array<std::vector<float>, Dim> u, f;
      std::array<std::vector<float>, Dim*(Dim + 1) / 2> g;
      MappedRow<Dim> row;
      row.row = r;
      row.begin = 2;
      row.end = raster.size[0] - 1;
      row.start = raster.row_start(r);
      row.step = raster.index_to_point().col(0);
      ForceRow<Dim> out;
      for (int a = 0; a < Dim; ++a) {
        u[a].assign(width + 32, 0.0f);
        f[a].assign(width + 32, 0.0f);
        for (std::size_t i = 0; i < width; ++i) {
          const Point<Dim> x = row.start + static_cast<double>(i) * row.step;
          u[a][i] = static_cast<float>(mapped[static_cast<std::size_t>(r) * width + i][a] - x[a]);
        }
        if (metric.needs_map(pass)) row.displacement[a] = u[a].data();
        if (pass + 1 == metric.num_passes()) out.force[a] = f[a].data();
      }
      for (std::size_t k = 0; k < g.size(); ++k) {
        g[k].assign(width / 4 + 2, 0.0f);
        if (pass + 1 == metric.num_passes()) out.curvature[k] = g[k].data();
      }
      sums.push_back(metric.new_sums());
      metric.evaluate_row(pass, row, out, *sums.back());
      for (std::size_t i = 0; i < width; ++i) {
        Vector<Dim> force;
        for (int a = 0; a < Dim; ++a) force[a] = f[a][i];
        const bool swept = static_cast<int>(i) >= row.begin && static_cast<int>(i) < row.end;
        result.forces.push_back(swept ? force : Vector<Dim>::Zero().eval());
      }
      double trace = 0;
      for (float v : g[0]) trace += v;
      for (float v : g[Dim == 2 ? 2 : 3]) trace += v;
      if (Dim == 3) {
        for (float v : g.back()) trace += v;
      }
      result.curvature_trace.push_back(trace);
    }
    result.value = metric.finish_pass(pass, sums);
  }
  return result;
}

}  // namespace crease::testing
