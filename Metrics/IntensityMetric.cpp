#include "Metrics/IntensityMetric.h"

#include <algorithm>

#include "Core/Cpu.h"
#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Metrics/IntensityKernel.h"

namespace crease {
namespace {

constexpr int kMargin = 16;  // entries that an interpolator may write beyond the row

/// Slopes of one row; kept by each thread for its next row.
struct SlopeBuffers {
  std::vector<float> by_moving, curvature, by_weight, inside;

  void resize(std::size_t size) {
    for (auto* row : {&by_moving, &curvature, &by_weight, &inside}) row->resize(size);
  }
  /// Of samples beside begin .. end-1 that are read with them.
  void clear_beside(int begin, int end) {
    for (int beside : {begin - 1, begin - 2, begin - 3, end, end + 1, end + 2}) {
      const auto at = static_cast<std::size_t>(kMargin + beside);
      by_moving[at] = curvature[at] = by_weight[at] = 0;
    }
  }
};

SlopeBuffers& buffers(std::size_t size) {
  static thread_local SlopeBuffers instance;
  instance.resize(size);
  return instance;
}

}  // namespace

template <int Dim>
void IntensityMetric<Dim>::Field::resize(std::size_t size) {
  value.resize(size);
  for (auto& g : gradient) g.resize(size);
}

template <int Dim>
void IntensityMetric<Dim>::describe_fixed() {
  const auto& fixed = input_.fixed.values();
  double sum = 0, squares = 0;
  FixedStatistics& s = statistics_;
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    const double w = input_.weights[i], f = fixed[i];
    if (w == 0) continue;
    s.lower = s.weight == 0 ? f : std::min(s.lower, f);
    s.upper = s.weight == 0 ? f : std::max(s.upper, f);
    s.weight += w;
    sum += w * f;
    squares += w * f * f;
  }
  s.mean = sum / s.weight;
  s.variance = std::max(0.0, squares / s.weight - s.mean * s.mean);
}

template <int Dim>
IntensityMetric<Dim>::IntensityMetric(MetricInput<Dim> input) : input_(std::move(input)) {
  check(input_);
  describe_fixed();
  const Raster<Dim>& raster = fixed_raster();
  const auto width = static_cast<std::size_t>(raster.size[0]);
  const auto rows = static_cast<std::size_t>(raster.num_rows());
  stride_ = (width + 15) / 16 * 16 + 2 * kMargin;
  fixed_.assign(rows * stride_, 0.0f);
  weight_.assign(rows * stride_, 0.0f);
  for (std::size_t r = 0; r < rows; ++r) {
    const std::size_t to = r * stride_ + kMargin;
    for (std::size_t i = 0; i < width; ++i) {
      const double value = input_.fixed.values()[r * width + i];
      weight_[to + i] = input_.weights[r * width + i];
      if (weight_[to + i] > 0) fixed_[to + i] = static_cast<float>(value - statistics_.mean);
    }
  }
  moving_.resize(rows * stride_);
  if (input_.moving_mask != nullptr) {
    mask_.resize(rows * stride_);
    effective_ = weight_;
  }
}

template <int Dim>
std::size_t IntensityMetric<Dim>::place(std::int64_t row) const {
  return static_cast<std::size_t>(row) * stride_ + kMargin;
}

template <int Dim>
typename IntensityMetric<Dim>::Samples IntensityMetric<Dim>::kept(std::int64_t row) const {
  const std::size_t at = place(row);
  const auto& weight = input_.moving_mask != nullptr ? effective_ : weight_;
  return {row, 0, fixed_raster().size[0], &weight[at], &fixed_[at], &moving_.value[at]};
}

template <int Dim>
void IntensityMetric<Dim>::sample(const MappedRow<Dim>& row, Sums& sums) const {
  const std::size_t at = place(row.row);
  float* inside = buffers(stride_).inside.data() + kMargin;
  const auto interpolate = [&](const Interpolator<Dim>& image, Field& field) {
    std::array<float*, Dim> gradient;
    for (int a = 0; a < Dim; ++a) gradient[a] = &field.gradient[a][at];
    image.evaluate_row(row, &field.value[at], gradient, inside);
    for (int i : {row.begin - 1, row.begin - 2, row.begin - 3, row.end, row.end + 1, row.end + 2}) {
      const auto beside = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(at) + i);
      field.value[beside] = 0;
      for (auto& g : field.gradient) g[beside] = 0;
    }
  };
  if (input_.moving_mask != nullptr) {
    interpolate(*input_.moving_mask, mask_);
    for (int i = row.begin; i < row.end; ++i) {
      effective_[at + i] = weight_[at + i] * mask_.value[at + i];
    }
  }
  interpolate(*input_.moving, moving_);
  Samples samples = kept(row.row);
  samples.begin = row.begin;
  samples.end = row.end;
  const auto weigh = cpu_has_avx2() ? avx2::weight_sums : baseline::weight_sums;
  const WeightSums weights =
      weigh(samples.weight + row.begin, inside + row.begin, row.end - row.begin);
  sums.weight += weights.weight;
  sums.weight_inside += weights.weight_inside;
  add(samples, sums);
}

template <int Dim>
void IntensityMetric<Dim>::carry(const MappedRow<Dim>& row, const ForceRow<Dim>& out) const {
  const std::size_t at = place(row.row);
  SlopeBuffers& slopes = buffers(stride_);
  const bool masked = input_.moving_mask != nullptr;
  Samples samples = kept(row.row);
  samples.begin = row.begin;
  samples.end = row.end;
  differentiate(samples, {slopes.by_moving.data() + kMargin, slopes.curvature.data() + kMargin,
                          masked ? slopes.by_weight.data() + kMargin : nullptr});
  slopes.clear_beside(row.begin, row.end);
  SlopeRow kernel_row;
  kernel_row.begin = row.begin;
  kernel_row.end = row.end;
  kernel_row.slope = slopes.by_moving.data() + kMargin;
  kernel_row.curvature = slopes.curvature.data() + kMargin;
  if (masked) {
    for (int i = row.begin; i < row.end; ++i) {  // w_x = w m: by the mask
      slopes.by_weight[static_cast<std::size_t>(kMargin + i)] *= weight_[at + i];
    }
    kernel_row.mask_slope = slopes.by_weight.data() + kMargin;
  }
  for (int a = 0; a < Dim; ++a) {
    kernel_row.gradient[a] = &moving_.gradient[a][at];
    if (masked) kernel_row.mask_gradient[a] = &mask_.gradient[a][at];
    kernel_row.force[a] = out.force[a];
  }
  for (std::size_t k = 0; k < out.curvature.size(); ++k) {
    kernel_row.curvature_sum[k] = out.curvature[k];
  }
  cpu_has_avx2() ? avx2::carry_slopes(kernel_row, Dim) : baseline::carry_slopes(kernel_row, Dim);
}

template <int Dim>
void IntensityMetric<Dim>::evaluate_row(int pass, const MappedRow<Dim>& row,
                                        const ForceRow<Dim>& out, Sums& sums) const {
  if (row.begin >= row.end) return;
  if (pass == 0) {
    sample(row, sums);
  } else if (out.force[0] != nullptr) {
    carry(row, out);
  }
}

template <int Dim>
double IntensityMetric<Dim>::finish_pass(int pass, std::span<const std::unique_ptr<Sums>> tiles) {
  if (pass == 0) {
    double weight = 0, weight_inside = 0;
    for (const auto& tile : tiles) {
      weight += tile->weight;
      weight_inside += tile->weight_inside;
    }
    check_overlap(this->name().c_str(), weight_inside, weight);
    value_ = summarise(tiles);
  }
  return value_;
}

template <int Dim>
double IntensityMetric<Dim>::evaluate(std::span<const Point<Dim>> mapped,
                                      std::span<Vector<Dim>> forces) const {
  const auto& fixed = input_.fixed.values();
  if (mapped.size() != fixed.size() || (!forces.empty() && forces.size() != fixed.size())) {
    throw InvalidInput(message(this->name(), ": ", mapped.size(), " mapped points and ",
                               forces.size(), " forces for ", fixed.size(), " samples"));
  }
  Reference all;
  for (auto* values : {&all.weight, &all.fixed, &all.moving, &all.by_moving, &all.by_weight}) {
    values->assign(fixed.size(), 0.0);
  }
  std::vector<Vector<Dim>> gradient(fixed.size()), of_mask(fixed.size(), Vector<Dim>::Zero());
  parallel_for(std::ssize(mapped), [&](std::int64_t k) {
    const auto i = static_cast<std::size_t>(k);
    const auto moving = input_.moving->evaluate(mapped[i]);
    all.fixed[i] = fixed[i];
    all.moving[i] = moving.value;
    all.weight[i] = input_.weights[i];
    gradient[i] = moving.gradient;
    if (input_.moving_mask == nullptr) return;
    const auto mask = input_.moving_mask->evaluate(mapped[i]);
    all.weight[i] *= mask.value;
    of_mask[i] = input_.weights[i] * mask.gradient;
  });
  const double value = reference(all);
  if (forces.empty()) return value;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    forces[i] = all.by_moving[i] * gradient[i] + all.by_weight[i] * of_mask[i];
  }
  return value;
}

template class IntensityMetric<2>;
template class IntensityMetric<3>;

}  // namespace crease
