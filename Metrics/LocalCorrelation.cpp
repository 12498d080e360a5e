#include "Metrics/LocalCorrelation.h"

#include <cmath>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Metrics/WindowSums.h"

namespace crease {
namespace {

constexpr double kLeastContrast = 1e-3;  // of a window, relative to the variance of the whole image

/// What multiplies aa, bb, ab, a, b and 1 in weight_slope().
std::array<double, 6> weight_polynomial(const Correlation& c) {
  return {c.by_aa,
          c.by_bb,
          c.by_ab,
          -2 * c.by_aa * c.mean_a - c.by_ab * c.mean_b,
          -2 * c.by_bb * c.mean_b - c.by_ab * c.mean_a,
          c.by_aa * c.mean_a * c.mean_a + c.by_bb * c.mean_b * c.mean_b +
              c.by_ab * c.mean_a * c.mean_b};
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

/// of_sample(weight, fixed, moving) of every sample with a weight, 0 elsewhere.
template <int Dim>
typename LocalCorrelation<Dim>::Field LocalCorrelation<Dim>::field(const auto& of_sample) const {
  const std::int64_t rows = this->fixed_raster().num_rows();
  Field values(static_cast<std::size_t>(rows) * this->row_stride(), 0.0f);
  parallel_for((rows + 15) / 16, [&](std::int64_t part) {
    for (std::int64_t r = 16 * part; r < std::min(rows, 16 * part + 16); ++r) {
      const Samples row = this->kept(r);
      float* out = &values[static_cast<std::size_t>(r) * this->row_stride()];
      const auto shift = static_cast<float>(moving_shift_);
      for (int i = row.begin; i < row.end; ++i) {
        if (row.weight[i] != 0) {
          out[i] = of_sample(row.weight[i], row.fixed[i], row.moving[i] - shift);
        }
      }
    }
  });
  return values;
}

/// The windows of the fixed image that count, and the unit.
template <int Dim>
void LocalCorrelation<Dim>::find_contrast() {
  Field w = field([](float weight, float, float) { return weight; });
  Field a = field([](float weight, float f, float) { return weight * f; });
  Field aa = field([](float weight, float f, float) { return weight * f * f; });
  for (Field* values : {&w, &a, &aa}) sum_windows(*values, size(), this->row_stride(), radius_);
  const double least = kLeastContrast * this->fixed_statistics().variance;
  contrast_.assign(w.size(), 0);
  double sum = 0;
  for (std::int64_t r = 0; r < this->fixed_raster().num_rows(); ++r) {
    const Samples row = this->kept(r);
    for (int i = row.begin; i < row.end; ++i) {
      const std::size_t at = static_cast<std::size_t>(r) * this->row_stride() + i;
      if (!(w[at] > 0)) continue;
      const double mean = static_cast<double>(a[at]) / w[at];
      const double variance = static_cast<double>(aa[at]) / w[at] - mean * mean;
      contrast_[at] = variance > least ? 1 : 0;
      if (contrast_[at]) sum += row.weight[i] * variance;
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

template <int Dim>
double LocalCorrelation<Dim>::summarise(
    std::span<const std::unique_ptr<typename Metric<Dim>::Sums>>) {
  std::array<Field, 6> sums = {field([](float w, float, float) { return w; }),
                               field([](float w, float a, float) { return w * a; }),
                               field([](float w, float, float b) { return w * b; }),
                               field([](float w, float a, float) { return w * a * a; }),
                               field([](float w, float, float b) { return w * b * b; }),
                               field([](float w, float a, float b) { return w * a * b; })};
  const std::size_t stride = this->row_stride();
  for (Field& values : sums) sum_windows(values, size(), stride, radius_);
  const bool masked = this->input().moving_mask != nullptr;
  for (Field& values : by_moving_) values.assign(sums[0].size(), 0.0f);
  if (masked) {
    for (Field& values : by_weight_) values.assign(sums[0].size(), 0.0f);
    value_.assign(sums[0].size(), 0.0f);
  }
  const auto total = parallel_sum(
      this->fixed_raster().num_rows(), ValueSums{},
      [&](std::int64_t r, ValueSums& sum) {
        const Samples row = this->kept(r);
        for (int i = row.begin; i < row.end; ++i) {
          if (row.weight[i] == 0 || !counts(r, i)) continue;
          const std::size_t at = static_cast<std::size_t>(r) * stride + i;
          const Correlation c = correlation(
              {sums[0][at], sums[1][at], sums[2][at], sums[3][at], sums[4][at], sums[5][at]});
          const double w = row.weight[i];
          sum += {w * c.value, w};
          by_moving_[0][at] = static_cast<float>(w * c.by_a);
          by_moving_[1][at] = static_cast<float>(w * c.by_b);
          by_moving_[2][at] = static_cast<float>(-w * (c.by_a * c.mean_a + c.by_b * c.mean_b));
          by_moving_[3][at] = static_cast<float>(w * c.curvature);
          if (!masked) continue;
          const auto polynomial = weight_polynomial(c);
          for (int k = 0; k < 6; ++k) by_weight_[k][at] = static_cast<float>(w * polynomial[k]);
          value_[at] = static_cast<float>(c.value);
        }
      },
      16);
  if (!(total.weight > 0)) throw SolverError("lncc: no window has any sample that counts");
  const double mean = total.value / total.weight;
  const auto per_weight = static_cast<float>(1 / total.weight);
  const auto finish = [&](Field& values) {
    for (float& v : values) v *= per_weight;
    sum_windows(values, size(), stride, radius_);
  };
  for (Field& values : by_moving_) finish(values);
  if (masked) {
    for (Field& values : by_weight_) finish(values);
    for (std::size_t i = 0; i < value_.size(); ++i) {
      value_[i] = contrast_[i] ? (value_[i] - static_cast<float>(mean)) * per_weight : 0.0f;
    }
  }
  return mean;
}

template <int Dim>
void LocalCorrelation<Dim>::differentiate(const Samples& row, const Slopes& out) const {
  const std::size_t at = static_cast<std::size_t>(row.row) * this->row_stride();
  const auto shift = static_cast<float>(moving_shift_);
  for (int i = row.begin; i < row.end; ++i) {
    const float a = row.fixed[i], b = row.moving[i] - shift;
    out.by_moving[i] = row.weight[i] * (by_moving_[0][at + i] * a + by_moving_[1][at + i] * b +
                                        by_moving_[2][at + i]);
    out.curvature[i] = row.weight[i] * by_moving_[3][at + i];
    if (out.by_weight == nullptr) continue;
    const auto& p = by_weight_;
    out.by_weight[i] = value_[at + i] + p[0][at + i] * a * a + p[1][at + i] * b * b +
                       p[2][at + i] * a * b + p[3][at + i] * a + p[4][at + i] * b + p[5][at + i];
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
