#include "Metrics/SumOfSquaredDifferences.h"

#include <algorithm>

#include "Core/Cpu.h"
#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Metrics/SumOfSquaredDifferencesKernel.h"

namespace crease {
namespace {

constexpr int kMargin = 16;  // entries that an interpolator may write beyond the row

/// Value, gradient and inside flag of an image along one row, with room on both sides.
template <int Dim>
struct FieldRow {
  std::vector<float> value, inside;
  std::array<std::vector<float>, Dim> gradient;

  void interpolate(const Interpolator<Dim>& image, const MappedRow<Dim>& row, std::size_t size) {
    std::array<float*, Dim> gradients;
    value.resize(size);
    inside.resize(size);
    for (int a = 0; a < Dim; ++a) {
      gradient[a].resize(size);
      gradients[a] = gradient[a].data() + kMargin;
    }
    image.evaluate_row(row, value.data() + kMargin, gradients, inside.data() + kMargin);
    clear(row.begin / 4 * 4, row.begin);
    clear(row.end, (row.end + 3) / 4 * 4);
  }

 private:
  void clear(int begin, int end) {
    const auto zero = [&](std::vector<float>& v) {
      std::fill(v.begin() + kMargin + begin, v.begin() + kMargin + end, 0.0f);
    };
    zero(value);
    zero(inside);
    for (auto& g : gradient) zero(g);
  }
};

/// What each thread needs for a row; kept for its next row.
template <int Dim>
struct RowBuffers {
  FieldRow<Dim> moving, mask;
  std::vector<float> fixed, weight, unmasked;

  void interpolate(const MetricInput<Dim>& input, const MappedRow<Dim>& row) {
    const auto size = static_cast<std::size_t>(input.fixed.raster().size[0] + 3 * kMargin);
    moving.interpolate(*input.moving, row, size);
    if (input.moving_mask != nullptr) mask.interpolate(*input.moving_mask, row, size);
  }

  /// Fixed values and weights of the row; what is left of the last row outside it gets weight 0.
  void copy_fixed(const MetricInput<Dim>& input, const MappedRow<Dim>& row) {
    const int width = input.fixed.raster().size[0];
    const std::int64_t offset = row.row * width;
    fixed.resize(static_cast<std::size_t>(width + kMargin));
    weight.assign(static_cast<std::size_t>(width + kMargin), 0.0f);
    std::copy(input.fixed.values().begin() + offset + row.begin,
              input.fixed.values().begin() + offset + row.end, fixed.begin() + row.begin);
    std::copy(input.weights.begin() + offset + row.begin, input.weights.begin() + offset + row.end,
              weight.begin() + row.begin);
    if (input.moving_mask == nullptr) return;
    unmasked = weight;
    for (int i = row.begin; i < row.end; ++i) {
      weight[static_cast<std::size_t>(i)] *= mask.value[static_cast<std::size_t>(i + kMargin)];
    }
  }
};

template <int Dim>
RowBuffers<Dim>& buffers() {
  static thread_local RowBuffers<Dim> instance;
  return instance;
}

}  // namespace

template <int Dim>
SumOfSquaredDifferences<Dim>::SumOfSquaredDifferences(MetricInput<Dim> input)
    : input_(std::move(input)) {
  check(input_);
}

template <int Dim>
void SumOfSquaredDifferences<Dim>::evaluate_row(int, const MappedRow<Dim>& row,
                                                const ForceRow<Dim>& out,
                                                typename Metric<Dim>::Sums& sums) const {
  if (row.begin >= row.end) return;
  RowBuffers<Dim>& b = buffers<Dim>();
  const auto& raster = fixed_raster();
  b.interpolate(input_, row);
  b.copy_fixed(input_, row);

  SsdRow kernel_row;
  kernel_row.begin = row.begin;
  kernel_row.end = row.end;
  kernel_row.fixed = b.fixed.data();
  kernel_row.weight = b.weight.data();
  kernel_row.value = b.moving.value.data() + kMargin;
  kernel_row.inside = b.moving.inside.data() + kMargin;
  kernel_row.volume = static_cast<float>(raster.sample_volume());
  for (int a = 0; a < Dim; ++a) {
    kernel_row.gradient[a] = b.moving.gradient[a].data() + kMargin;
    kernel_row.force[a] = out.force[a];
  }
  for (std::size_t k = 0; k < out.curvature.size(); ++k) kernel_row.curvature[k] = out.curvature[k];
  const SsdSums found =
      cpu_has_avx2() ? avx2::ssd_row(kernel_row, Dim) : baseline::ssd_row(kernel_row, Dim);
  sums.value += 0.5 * raster.sample_volume() * found.squares;
  sums.weight += found.weight;
  sums.weight_inside += found.weight_inside;

  if (input_.moving_mask == nullptr || out.force[0] == nullptr) return;
  for (int i = row.begin; i < row.end; ++i) {
    const auto k = static_cast<std::size_t>(i + kMargin);
    const float d = b.moving.value[k] - b.fixed[static_cast<std::size_t>(i)];
    const float half = 0.5f * b.unmasked[static_cast<std::size_t>(i)] * d * d * kernel_row.volume;
    for (int a = 0; a < Dim; ++a) out.force[a][i] += half * b.mask.gradient[a][k];
  }
}

template <int Dim>
double SumOfSquaredDifferences<Dim>::finish_pass(
    int, std::span<const std::unique_ptr<typename Metric<Dim>::Sums>> tiles) {
  typename Metric<Dim>::Sums total;
  for (const auto& tile : tiles) {
    total.value += tile->value;
    total.weight += tile->weight;
    total.weight_inside += tile->weight_inside;
  }
  check_overlap("sum of squared differences", total.weight_inside, total.weight);
  return total.value;
}

template <int Dim>
double SumOfSquaredDifferences<Dim>::evaluate(std::span<const Point<Dim>> mapped,
                                              std::span<Vector<Dim>> forces) const {
  const auto& fixed = input_.fixed.values();
  if (mapped.size() != fixed.size() || (!forces.empty() && forces.size() != fixed.size())) {
    throw InvalidInput(message("sum of squared differences: ", mapped.size(), " mapped points and ",
                               forces.size(), " forces for ", fixed.size(), " samples"));
  }
  const double volume = fixed_raster().sample_volume();
  return parallel_sum(std::ssize(mapped), 0.0, [&](std::int64_t k, double& sum) {
    const auto i = static_cast<std::size_t>(k);
    if (!forces.empty()) forces[i].setZero();
    if (input_.weights[i] == 0) return;
    const auto moving = input_.moving->evaluate(mapped[i]);
    const double difference = moving.value - static_cast<double>(fixed[i]);
    const double weight = input_.weights[i] * volume;
    double inside = 1;
    Vector<Dim> inside_gradient = Vector<Dim>::Zero();
    if (input_.moving_mask != nullptr) {
      const auto mask = input_.moving_mask->evaluate(mapped[i]);
      inside = mask.value;
      inside_gradient = mask.gradient;
    }
    sum += 0.5 * weight * inside * difference * difference;
    if (forces.empty()) return;
    forces[i] = weight * inside * difference * moving.gradient +
                0.5 * weight * difference * difference * inside_gradient;
  });
}

template class SumOfSquaredDifferences<2>;
template class SumOfSquaredDifferences<3>;

}  // namespace crease
