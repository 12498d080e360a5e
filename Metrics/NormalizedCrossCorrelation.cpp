#include "Metrics/NormalizedCrossCorrelation.h"

#include <algorithm>
#include <cmath>

#include "Core/Cpu.h"
#include "Core/Error.h"
#include "Metrics/IntensityKernel.h"

namespace crease {
namespace {

constexpr double kRounding =
    1e-12;  // relative variance that single precision makes of a constant image

template <int Dim>
struct NccSums final : Metric<Dim>::Sums {
  CorrelationSums products;
};

CorrelationSums from_kernel(const ProductSums& sums) {
  const double* v = sums.values;
  return {v[0], v[1], v[2], v[3], v[4], v[5]};
}

}  // namespace

template <int Dim>
NormalizedCrossCorrelation<Dim>::NormalizedCrossCorrelation(MetricInput<Dim> input, bool squared)
    : IntensityMetric<Dim>(std::move(input)), squared_(squared) {
  const IntensityRange range = this->input().moving->coefficient_range();
  const double largest = std::max(std::abs(range.lower), std::abs(range.upper));
  least_ = {0, kRounding * largest * largest};
}

template <int Dim>
Correlation NormalizedCrossCorrelation<Dim>::correlation(const CorrelationSums& sums) const {
  const Correlation found = correlate(sums, squared_, least_);
  if (!found.has_contrast) {
    throw SolverError(
        "ncc: the moving image is constant where it is compared; check the masks and the start");
  }
  return found;
}

template <int Dim>
std::unique_ptr<typename Metric<Dim>::Sums> NormalizedCrossCorrelation<Dim>::new_sums() const {
  return std::make_unique<NccSums<Dim>>();
}

template <int Dim>
double NormalizedCrossCorrelation<Dim>::unit() const {
  const auto& fixed = this->fixed_statistics();
  const double half = squared_ ? 0.5 : 1;  // 1 - c^2 falls twice as fast as 1 - c
  return half * fixed.variance * fixed.weight * this->fixed_raster().sample_volume();
}

template <int Dim>
void NormalizedCrossCorrelation<Dim>::add(const Samples& row,
                                          typename Metric<Dim>::Sums& sums) const {
  const auto kernel = cpu_has_avx2() ? avx2::product_sums : baseline::product_sums;
  static_cast<NccSums<Dim>&>(sums).products += from_kernel(kernel(
      row.weight + row.begin, row.fixed + row.begin, row.moving + row.begin, row.end - row.begin));
}

template <int Dim>
double NormalizedCrossCorrelation<Dim>::summarise(
    std::span<const std::unique_ptr<typename Metric<Dim>::Sums>> tiles) {
  CorrelationSums total;
  for (const auto& tile : tiles) total += static_cast<const NccSums<Dim>&>(*tile).products;
  correlation_ = correlation(total);
  return correlation_.value;
}

template <int Dim>
void NormalizedCrossCorrelation<Dim>::differentiate(const Samples& row, const Slopes& out) const {
  const Correlation& c = correlation_;
  CorrelationRow slopes;
  slopes.count = row.end - row.begin;
  slopes.weight = row.weight + row.begin;
  slopes.a = row.fixed + row.begin;
  slopes.b = row.moving + row.begin;
  slopes.by_a = static_cast<float>(c.by_a);
  slopes.by_b = static_cast<float>(c.by_b);
  slopes.mean_a = static_cast<float>(c.mean_a);
  slopes.mean_b = static_cast<float>(c.mean_b);
  slopes.c = static_cast<float>(c.curvature);
  slopes.slope = out.by_moving + row.begin;
  slopes.curvature = out.curvature + row.begin;
  cpu_has_avx2() ? avx2::correlation_slopes(slopes) : baseline::correlation_slopes(slopes);
  if (out.by_weight == nullptr) return;
  for (int i = row.begin; i < row.end; ++i) {
    out.by_weight[i] = static_cast<float>(c.weight_slope(row.fixed[i], row.moving[i]));
  }
}

template <int Dim>
double NormalizedCrossCorrelation<Dim>::reference(Reference& all) const {
  CorrelationSums sums;
  for (std::size_t i = 0; i < all.weight.size(); ++i) {
    const double w = all.weight[i], a = all.fixed[i], b = all.moving[i];
    sums += {w, w * a, w * b, w * a * a, w * b * b, w * a * b};
  }
  const Correlation c = correlation(sums);
  for (std::size_t i = 0; i < all.weight.size(); ++i) {
    const double a = all.fixed[i] - c.mean_a, b = all.moving[i] - c.mean_b;
    all.by_moving[i] = all.weight[i] * (c.by_a * a + c.by_b * b);
    all.by_weight[i] = c.weight_slope(all.fixed[i], all.moving[i]);
  }
  return c.value;
}

template class NormalizedCrossCorrelation<2>;
template class NormalizedCrossCorrelation<3>;

}  // namespace crease
