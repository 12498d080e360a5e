#include "Transforms/SparseRowGrid.h"

#include <algorithm>
#include <limits>

#include "Core/Parallel.h"
#include "Transforms/ControlPointSums.h"

namespace crease {
namespace {

constexpr int kSumBlock = 64;

template <int Dim>
struct FloatCoefficients final : BoundGrid<Dim>::Coefficients {
  std::array<std::vector<float>, Dim> phi;
};

template <int Dim>
struct RowSums final : BoundGrid<Dim>::Accumulator {
  explicit RowSums(int num_control_points) : sums(num_control_points, kSumBlock) {}
  ControlPointSums<Dim> sums;
};

/// The packed symmetric matrix of block b.
template <int Dim>
Matrix<Dim> curvature(const CurvatureBlocks<Dim>& blocks, std::size_t b) {
  Matrix<Dim> g;
  for (int a = 0, s = 0; a < Dim; ++a) {
    for (int c = a; c < Dim; ++c, ++s) g(a, c) = g(c, a) = blocks.sums[s][b];
  }
  return g;
}

}  // namespace

template <int Dim>
SparseRowGrid<Dim>::SparseRowGrid(const SplineBasis<Dim>& basis, const Raster<Dim>& raster)
    : raster_(raster),
      num_control_points_(basis.num_control_points()),
      rows_(static_cast<std::size_t>(raster.num_rows())) {
  parallel_for(std::ssize(rows_),
               [&](std::int64_t r) { rows_[static_cast<std::size_t>(r)] = build_row(basis, r); });
}

template <int Dim>
typename SparseRowGrid<Dim>::Row SparseRowGrid<Dim>::build_row(const SplineBasis<Dim>& basis,
                                                               std::int64_t r) const {
  Row row;
  const Point<Dim> start = raster_.row_start(r);
  const Vector<Dim> step = raster_.index_to_point().col(0);
  std::vector<Eigen::VectorXd> run_values;
  const auto close_run = [&] {
    if (run_values.empty()) return;
    Run& run = row.runs.back();
    run.end = run.begin + static_cast<int>(run_values.size());
    run.weights = row.weights.size();
    for (std::size_t c = 0; c < run.num_control_points; ++c) {
      for (const auto& values : run_values) row.weights.push_back(static_cast<float>(values[c]));
    }
    run_values.clear();
  };
  for (int i = 0; i < raster_.size[0]; ++i) {
    const Point<Dim> x = start + i * step;
    if (!basis.contains(x)) {
      close_run();
      continue;
    }
    const auto here = basis.evaluate(x);
    if (run_values.empty() || !std::ranges::equal(row.of(row.runs.back()), here.control_points)) {
      close_run();
      Run run;
      run.begin = i;
      run.control_points = row.control_points.size();
      run.num_control_points = here.control_points.size();
      row.runs.push_back(run);
      row.control_points.insert(row.control_points.end(), here.control_points.begin(),
                                here.control_points.end());
    }
    run_values.push_back(here.values);
  }
  close_run();
  return row;
}

template <int Dim>
std::pair<int, int> SparseRowGrid<Dim>::row_range(std::int64_t row) const {
  const auto& runs = rows_[static_cast<std::size_t>(row)].runs;
  return runs.empty() ? std::pair(0, 0) : std::pair(runs.front().begin, runs.back().end);
}

template <int Dim>
void SparseRowGrid<Dim>::coverage(std::int64_t row, std::span<std::uint8_t> inside) const {
  std::ranges::fill(inside, std::uint8_t{0});
  for (const Run& run : rows_[static_cast<std::size_t>(row)].runs) {
    std::fill(inside.begin() + run.begin, inside.begin() + run.end, std::uint8_t{1});
  }
}

template <int Dim>
std::unique_ptr<typename SparseRowGrid<Dim>::Coefficients> SparseRowGrid<Dim>::prepare(
    const Eigen::Ref<const ControlPoints<Dim>>& control_points) const {
  auto coefficients = std::make_unique<FloatCoefficients<Dim>>();
  for (int a = 0; a < Dim; ++a) {
    auto& phi = coefficients->phi[a];
    phi.resize(static_cast<std::size_t>(num_control_points_));
    for (int i = 0; i < num_control_points_; ++i) phi[i] = static_cast<float>(control_points(a, i));
  }
  return coefficients;
}

template <int Dim>
void SparseRowGrid<Dim>::map_row(const Coefficients& coefficients, std::int64_t row_number,
                                 const std::array<float*, Dim>& out) const {
  const auto& phi = static_cast<const FloatCoefficients<Dim>&>(coefficients).phi;
  const Row& row = rows_[static_cast<std::size_t>(row_number)];
  const auto [begin, end] = row_range(row_number);
  for (int a = 0; a < Dim; ++a) std::fill(out[a] + begin, out[a] + end, 0.0f);
  for (const Run& run : row.runs) {
    const auto numbers = row.of(run);
    const int length = run.end - run.begin;
    for (std::size_t c = 0; c < numbers.size(); ++c) {
      const float* weights = row.weights.data() + run.weights + c * length;
      for (int a = 0; a < Dim; ++a) {
        const float value = phi[a][numbers[c]];
        float* target = out[a] + run.begin;
        for (int i = 0; i < length; ++i) target[i] += weights[i] * value;
      }
    }
  }
}

template <int Dim>
std::unique_ptr<typename SparseRowGrid<Dim>::Accumulator> SparseRowGrid<Dim>::new_accumulator()
    const {
  return std::make_unique<RowSums<Dim>>(num_control_points_);
}

template <int Dim>
void SparseRowGrid<Dim>::add_row(Accumulator& sums, std::int64_t row_number,
                                 const std::array<const float*, Dim>& force) const {
  auto& target = static_cast<RowSums<Dim>&>(sums).sums;
  const Row& row = rows_[static_cast<std::size_t>(row_number)];
  for (const Run& run : row.runs) {
    const auto numbers = row.of(run);
    const int length = run.end - run.begin;
    for (std::size_t c = 0; c < numbers.size(); ++c) {
      const float* weights = row.weights.data() + run.weights + c * length;
      for (int a = 0; a < Dim; ++a) {
        const float* f = force[a] + run.begin;
        double sum = 0;
        for (int i = 0; i < length; ++i) sum += double(weights[i]) * f[i];
        target.add(numbers[c], a, sum);
      }
    }
  }
}

template <int Dim>
void SparseRowGrid<Dim>::finish(std::span<const std::unique_ptr<Accumulator>> sums,
                                Eigen::Ref<ControlPoints<Dim>> gradient) const {
  for (const auto& s : sums) static_cast<const RowSums<Dim>&>(*s).sums.add_to(gradient);
}

// For every block the covered sample nearest to its middle one (the third of four along every axis).
template <int Dim>
std::vector<typename SparseRowGrid<Dim>::BlockSample> SparseRowGrid<Dim>::block_samples(
    const CurvatureBlocks<Dim>& blocks) const {
  constexpr int kBlock = CurvatureBlocks<Dim>::kBlock;
  const auto count = static_cast<std::size_t>(blocks.sums[0].size());
  std::vector<BlockSample> nearest(count, BlockSample{nullptr, nullptr, 0, 0});
  std::vector<double> distance(count, std::numeric_limits<double>::infinity());
  constexpr int kMiddle = kBlock / 2;
  const auto offset = [](std::int64_t i) { return static_cast<double>(i % kBlock - kMiddle); };
  for (std::int64_t r = 0; r < raster_.num_rows(); ++r) {
    const std::int64_t j = Dim == 2 ? r : r % raster_.size[1];
    const std::int64_t k = Dim == 2 ? 0 : r / raster_.size[1];
    double across = offset(j) * offset(j);
    if constexpr (Dim == 3) across += offset(k) * offset(k);
    const std::int64_t first = blocks.row_offset(r, raster_.size);
    const Row& row = rows_[static_cast<std::size_t>(r)];
    for (const Run& run : row.runs) {
      for (int i = run.begin; i < run.end; ++i) {
        const auto b = static_cast<std::size_t>(first + i / kBlock);
        const double d = across + offset(i) * offset(i);
        if (d < distance[b]) {
          distance[b] = d;
          nearest[b] = {&row, &run, i, b};
        }
      }
    }
  }
  std::erase_if(nearest, [](const BlockSample& s) { return s.run == nullptr; });
  return nearest;
}

// Blocks with the same control points are summed into one small dense matrix and scattered once.
template <int Dim>
void SparseRowGrid<Dim>::add_curvature(const CurvatureBlocks<Dim>& blocks, double scale,
                                       BlockHessian<Dim>& hessian) const {
  auto samples = block_samples(blocks);
  const auto numbers = [](const BlockSample& s) { return s.row->of(*s.run); };
  std::stable_sort(samples.begin(), samples.end(), [&](const auto& a, const auto& b) {
    return std::ranges::lexicographical_compare(numbers(a), numbers(b));
  });
  std::vector<std::size_t> start = {0};
  for (std::size_t s = 1; s <= samples.size(); ++s) {
    if (s == samples.size() || !std::ranges::equal(numbers(samples[s]), numbers(samples[s - 1]))) {
      start.push_back(s);
    }
  }
  if (samples.empty()) return;

  std::vector<std::vector<Matrix<Dim>>> sums(start.size() - 1);  // packed lower triangles
  parallel_for(std::ssize(sums), [&](std::int64_t group) {
    auto& sum = sums[static_cast<std::size_t>(group)];
    const std::size_t k = numbers(samples[start[group]]).size();
    sum.assign(k * (k + 1) / 2, Matrix<Dim>::Zero());
    for (std::size_t n = start[group]; n < start[group + 1]; ++n) {
      const BlockSample& s = samples[n];
      const Matrix<Dim> g = scale * curvature(blocks, s.block);
      if (g.isZero(0)) continue;
      const int length = s.run->end - s.run->begin;
      const float* weights = s.row->weights.data() + s.run->weights + (s.sample - s.run->begin);
      for (std::size_t i = 0, pair = 0; i < k; ++i) {
        for (std::size_t c = 0; c <= i; ++c, ++pair) {
          sum[pair] += double(weights[i * length]) * weights[c * length] * g;
        }
      }
    }
  });
  for (std::size_t group = 0; group < sums.size(); ++group) {
    const auto names = numbers(samples[start[group]]);
    for (std::size_t i = 0, pair = 0; i < names.size(); ++i) {
      for (std::size_t c = 0; c <= i; ++c, ++pair)
        hessian.add(names[i], names[c], sums[group][pair]);
    }
  }
}

template class SparseRowGrid<2>;
template class SparseRowGrid<3>;

}  // namespace crease
