#include "Metrics/LocalCorrelation.h"

#include <algorithm>
#include <cmath>

#include "Core/Cpu.h"
#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Metrics/LocalCorrelationKernel.h"
#include "Metrics/WindowSums.h"

namespace crease {
namespace {

constexpr double kLeastContrast = 1e-3;  // of a window, relative to the variance of the whole image

/// What the windows of one row are turned into, before they are summed; kept by each thread for its next row.
struct RowBuffers {
  std::vector<float> by_moving, by_weight;

  void resize(std::size_t size) {
    by_moving.resize(size);
    by_weight.resize(size);
  }
};

RowBuffers& buffers(std::size_t size) {
  static thread_local RowBuffers instance;
  instance.resize(size);
  return instance;
}

struct ValueSums {
  double value = 0, weight = 0;
  ValueSums& operator+=(const ValueSums& other) {
    value += other.value;
    weight += other.weight;
    return *this;
  }
};

}  // namespace

template <int Dim>
LocalCorrelation<Dim>::LocalCorrelation(MetricInput<Dim> input, int radius)
    : IntensityMetric<Dim>(std::move(input)), radius_(radius) {
  if (radius < 1 || radius > 64) {
    throw InvalidInput(message("lncc: windows of radius ", radius, "; give 1 to 64 samples"));
  }
  const IntensityRange range = this->input().moving->coefficient_range();
  moving_shift_ = 0.5 * (range.lower + range.upper);
  least_ = {0, 1e-9 * std::pow(std::max(range.width(), 1e-30), 2)};
  find_contrast();
}

template <int Dim>
std::array<int, 3> LocalCorrelation<Dim>::size() const {
  const auto& size = this->fixed_raster().size;
  return {size[0], size[1], Dim == 3 ? size[Dim - 1] : 1};
}

template <int Dim>
std::size_t LocalCorrelation<Dim>::row_size() const {
  return window_row_size(this->fixed_raster().size[0]);
}

template <int Dim>
WindowedRow LocalCorrelation<Dim>::windowed(const Samples& row) const {
  return {row.end - row.begin, row.weight + row.begin, row.fixed + row.begin,
          row.moving + row.begin, static_cast<float>(moving_shift_)};
}

/// The products of all samples, summed along rows.
template <int Dim>
void LocalCorrelation<Dim>::sum_products(bool of_fixed, Field& rows) const {
  const std::int64_t num_rows = this->fixed_raster().num_rows();
  rows.resize(static_cast<std::size_t>(num_rows) * row_size());
  const auto kernel = cpu_has_avx2() ? avx2::window_products : baseline::window_products;
  parallel_for((num_rows + 15) / 16, [&](std::int64_t part) {
    float* products = buffers(row_size()).by_moving.data();
    for (std::int64_t r = 16 * part; r < std::min(num_rows, 16 * part + 16); ++r) {
      const Samples row = this->kept(r);
      kernel(windowed(row), of_fixed ? products : nullptr, of_fixed ? nullptr : products);
      sum_along_row(products, row.end, radius_, &rows[static_cast<std::size_t>(r) * row_size()]);
    }
  });
}

/// Window sums of what has been summed along rows.
template <int Dim>
void LocalCorrelation<Dim>::sum_across(Field& rows) {
  scratch_.resize(rows.size());
  const std::span<float> to = window_target(rows, scratch_, size());
  sum_across_rows(rows, scratch_, size(), radius_, [&](std::int64_t r, const float* sums) {
    std::copy_n(sums, row_size(), &to[static_cast<std::size_t>(r) * row_size()]);
  });
  if (to.data() != rows.data()) rows.swap(scratch_);
}

/// The windows of the fixed image that count, and the unit.
template <int Dim>
void LocalCorrelation<Dim>::find_contrast() {
  sum_products(true, of_fixed_);
  sum_across(of_fixed_);
  const double least = kLeastContrast * this->fixed_statistics().variance;
  const std::int64_t num_rows = this->fixed_raster().num_rows();
  contrast_.assign(static_cast<std::size_t>(num_rows) * this->row_stride(), 0);
  double sum = 0;
  for (std::int64_t r = 0; r < num_rows; ++r) {
    const Samples row = this->kept(r);
    for (int i = row.begin; i < row.end; ++i) {
      const float* s = &of_fixed_[static_cast<std::size_t>(r) * row_size() + kWindowNumbers * i];
      if (!(s[0] > 0)) continue;
      const double mean = static_cast<double>(s[1]) / s[0];
      const double variance = static_cast<double>(s[2]) / s[0] - mean * mean;
      if (!(variance > least)) continue;
      contrast_[static_cast<std::size_t>(r) * this->row_stride() + i] = 1;
      sum += row.weight[i] * variance;
    }
  }
  unit_ = 0.5 * sum * this->fixed_raster().sample_volume();
  if (!(unit_ > 0)) {
    throw InvalidInput(message("lncc: the fixed image has no contrast within windows of radius ",
                               radius_, "; give a larger one"));
  }
}

template <int Dim>
Correlation LocalCorrelation<Dim>::correlation(const CorrelationSums& sums) const {
  return correlate(sums, true, least_);
}

/// Correlates all windows and sums what follows along rows, into by_moving_ and by_weight_.
template <int Dim>
CorrelatedSums LocalCorrelation<Dim>::correlate_rows() {
  const bool masked = this->input().moving_mask != nullptr;
  const auto num_rows = static_cast<std::size_t>(this->fixed_raster().num_rows());
  if (masked) {
    sum_products(true, of_fixed_);
    sum_across(of_fixed_);
    by_weight_.resize(num_rows * row_size());
    value_.resize(num_rows * row_size() / kWindowNumbers);
  }
  sum_products(false, by_moving_);
  scratch_.resize(by_moving_.size());
  const std::span<float> to = window_target(by_moving_, scratch_, size());
  std::vector<CorrelatedSums> found(num_rows);
  const auto kernel = cpu_has_avx2() ? avx2::correlate_windows : baseline::correlate_windows;
  sum_across_rows(by_moving_, scratch_, size(), radius_, [&](std::int64_t r, const float* sums) {
    const Samples row = this->kept(r);
    const std::size_t at = static_cast<std::size_t>(r) * row_size();
    RowBuffers& own = buffers(row_size());
    CorrelatedRow correlated;
    correlated.of_fixed = &of_fixed_[at];
    correlated.of_moving = sums;
    correlated.counts = &contrast_[static_cast<std::size_t>(r) * this->row_stride()];
    correlated.least_variance = least_.b;
    correlated.by_moving = own.by_moving.data();
    if (masked) {
      correlated.by_weight = own.by_weight.data();
      correlated.value = &value_[at / kWindowNumbers];
    }
    found[static_cast<std::size_t>(r)] = kernel(windowed(row), correlated);
    sum_along_row(correlated.by_moving, row.end, radius_, &to[at]);
    if (masked) sum_along_row(correlated.by_weight, row.end, radius_, &by_weight_[at]);
  });
  if (to.data() != by_moving_.data()) by_moving_.swap(scratch_);
  CorrelatedSums total;
  for (const CorrelatedSums& row : found) {
    total.value += row.value;
    total.weight += row.weight;
  }
  return total;
}

template <int Dim>
double LocalCorrelation<Dim>::summarise(
    std::span<const std::unique_ptr<typename Metric<Dim>::Sums>>) {
  const CorrelatedSums total = correlate_rows();
  if (!(total.weight > 0)) throw SolverError("lncc: no window has any sample that counts");
  sum_across(by_moving_);
  if (this->input().moving_mask != nullptr) sum_across(by_weight_);
  per_weight_ = 1 / total.weight;
  mean_ = total.value * per_weight_;
  return mean_;
}

template <int Dim>
void LocalCorrelation<Dim>::differentiate(const Samples& row, const Slopes& out) const {
  const std::size_t at = static_cast<std::size_t>(row.row) * row_size();
  WindowedSlopes slopes;
  slopes.by_moving = &by_moving_[at + kWindowNumbers * row.begin];
  slopes.per_weight = static_cast<float>(per_weight_);
  slopes.slope = out.by_moving + row.begin;
  slopes.curvature = out.curvature + row.begin;
  cpu_has_avx2() ? avx2::windowed_slopes(windowed(row), slopes)
                 : baseline::windowed_slopes(windowed(row), slopes);
  if (out.by_weight == nullptr) return;
  const auto shift = static_cast<float>(moving_shift_);
  for (int i = row.begin; i < row.end; ++i) {
    const float a = row.fixed[i], b = row.moving[i] - shift;
    const float* m = &by_moving_[at + kWindowNumbers * i];
    const float* w = &by_weight_[at + kWindowNumbers * i];
    double slope = w[0] * a * a + 0.5f * m[1] * b * b + m[0] * a * b + w[1] * a + m[2] * b + w[2];
    if (row.weight[i] != 0 && counts(row.row, i)) slope += value_[at / kWindowNumbers + i] - mean_;
    out.by_weight[i] = static_cast<float>(per_weight_ * slope);
  }
}

/// Window by window.
template <int Dim>
double LocalCorrelation<Dim>::reference(Reference& all) const {
  const auto n = size();
  const double mean_fixed = this->fixed_statistics().mean;
  struct Window {
    std::int64_t centre;
    Correlation correlation;
  };
  std::vector<Window> windows;
  ValueSums total;
  const auto visit = [&](std::int64_t centre, const auto& use) {
    const auto x = static_cast<int>(centre % n[0]), y = static_cast<int>(centre / n[0] % n[1]);
    const auto z = static_cast<int>(centre / n[0] / n[1]);
    for (int k = std::max(0, z - radius_); k <= std::min(n[2] - 1, z + radius_); ++k) {
      for (int j = std::max(0, y - radius_); j <= std::min(n[1] - 1, y + radius_); ++j) {
        for (int i = std::max(0, x - radius_); i <= std::min(n[0] - 1, x + radius_); ++i) {
          const auto at = (static_cast<std::size_t>(k) * n[1] + j) * n[0] + i;
          if (all.weight[at] != 0) {
            use(at, all.fixed[at] - mean_fixed, all.moving[at] - moving_shift_);
          }
        }
      }
    }
  };
  for (std::int64_t centre = 0; centre < std::ssize(all.weight); ++centre) {
    const double w = all.weight[static_cast<std::size_t>(centre)];
    if (w == 0 || !counts(centre / n[0], static_cast<int>(centre % n[0]))) continue;
    CorrelationSums sums;
    visit(centre, [&](std::size_t at, double a, double b) {
      const double v = all.weight[at];
      sums += {v, v * a, v * b, v * a * a, v * b * b, v * a * b};
    });
    windows.push_back({centre, correlation(sums)});
    total += {w * windows.back().correlation.value, w};
  }
  const double mean = total.value / total.weight;
  for (const Window& window : windows) {
    const Correlation& c = window.correlation;
    const auto centre = static_cast<std::size_t>(window.centre);
    const double share = all.weight[centre] / total.weight;
    all.by_weight[centre] += (c.value - mean) / total.weight;
    visit(window.centre, [&](std::size_t at, double a, double b) {
      all.by_moving[at] +=
          share * all.weight[at] * (c.by_a * (a - c.mean_a) + c.by_b * (b - c.mean_b));
      all.by_weight[at] += share * c.weight_slope(a, b);
    });
  }
  return mean;
}

template class LocalCorrelation<2>;
template class LocalCorrelation<3>;

}  // namespace crease
