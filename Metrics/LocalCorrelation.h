#pragma once

#include <array>
#include <vector>

#include "Metrics/Correlation.h"
#include "Metrics/IntensityMetric.h"

namespace crease {

struct CorrelatedSums;
struct WindowedRow;

/// Correlation in windows: for images whose gain and offset change from place to place (bias fields), of
/// either sign.
///
///     E = 1 - sum_x w s_ab(x)^2 / (s_aa(x) s_bb(x)) / sum_x w,
///
/// s sums of products of deviations, weighted, over the window about x. Windows where the fixed image has
/// no contrast (a thousandth of its variance) do not count; those where the moving one has none have no
/// correlation. Derivatives are window sums again, so that the cost does not depend on the radius.
///
/// Source: B. B. Avants et al., "Symmetric diffeomorphic image registration with cross-correlation",
/// Medical Image Analysis 12, 2008, for the metric; exact derivatives by the chain rule.
template <int Dim>
class LocalCorrelation final : public IntensityMetric<Dim> {
 public:
  /// @param radius  of the window, in samples: it has 2 radius + 1 a side; 1 to 64.
  /// @throws InvalidInput for another radius, when no sample has a weight, or when no window of the fixed
  /// image has contrast.
  explicit LocalCorrelation(MetricInput<Dim> input, int radius = 4);

  std::string name() const override { return "lncc"; }
  /// Half the fixed image's variance within windows times the measure of its samples.
  double unit() const override { return unit_; }
  bool expects_similar_intensities() const override { return true; }

 protected:
  using typename IntensityMetric<Dim>::Samples;
  using typename IntensityMetric<Dim>::Slopes;
  using typename IntensityMetric<Dim>::Reference;
  void add(const Samples&, typename Metric<Dim>::Sums&) const override {}
  double summarise(std::span<const std::unique_ptr<typename Metric<Dim>::Sums>> tiles) override;
  void differentiate(const Samples& row, const Slopes& out) const override;
  double reference(Reference& all) const override;

 private:
  using Field = std::vector<float>;  // four numbers per sample: WindowSums.h
  std::array<int, 3> size() const;
  std::size_t row_size() const;
  WindowedRow windowed(const Samples& row) const;
  void sum_products(bool of_fixed, Field& rows) const;
  void sum_across(Field& rows);
  void find_contrast();
  CorrelatedSums correlate_rows();
  Correlation correlation(const CorrelationSums& sums) const;
  bool counts(std::int64_t row, int i) const {
    return contrast_[static_cast<std::size_t>(row) * this->row_stride() + i] != 0;
  }

  int radius_;
  double unit_ = 1;
  double moving_shift_ = 0;  // near the middle of the moving image's range: keeps sums small
  LeastVariances least_;
  std::vector<std::uint8_t> contrast_;
  Field of_fixed_;  // window sums of w, w a and w a a
  // Of the last evaluation: window sums of what multiplies a, b and 1 in dE/db, and with a moving mask of what
  // multiplies a a, a and 1 in dE/dw; the rest of that follows from the former. All times the sum of weights.
  Field by_moving_, by_weight_, scratch_;
  std::vector<float> value_;  // of the sample's own window
  double mean_ = 0, per_weight_ = 0;
};

extern template class LocalCorrelation<2>;
extern template class LocalCorrelation<3>;

}  // namespace crease
