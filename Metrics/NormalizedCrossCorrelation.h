#pragma once

#include "Metrics/Correlation.h"
#include "Metrics/IntensityMetric.h"

namespace crease {

/// Normalised cross-correlation: for images whose intensities differ by a gain and an offset.
///
///     E = 1 - s_ab / (s_aa s_bb)^1/2,    s_ab = sum_x w a b,  a = I_f - mean I_f,  b = I_m(T) - mean I_m(T),
///     dE/dI_m = -w (a - b s_ab / s_bb) / (s_aa s_bb)^1/2,        curvature w / s_bb,
///
/// means weighted by w. With `squared` E = 1 - s_ab^2 / (s_aa s_bb), which contrast reversal leaves alone.
/// The curvature is that of 1/2 |a/|a| - b/|b||^2 but for a rank-one part, which makes it larger.
///
/// Source: registration theory 4.1.
template <int Dim>
class NormalizedCrossCorrelation final : public IntensityMetric<Dim> {
 public:
  /// @throws InvalidInput when no sample has a weight or the fixed image is constant where it counts.
  explicit NormalizedCrossCorrelation(MetricInput<Dim> input, bool squared = false);

  std::string name() const override { return "ncc"; }
  std::unique_ptr<typename Metric<Dim>::Sums> new_sums() const override;
  /// The fixed image's variance times the measure of its samples: the value is then half the integral of
  /// squares that a gain and an offset leave, near a match.
  double unit() const override;
  bool expects_similar_intensities() const override { return true; }

 protected:
  using typename IntensityMetric<Dim>::Samples;
  using typename IntensityMetric<Dim>::Slopes;
  using typename IntensityMetric<Dim>::Reference;
  void add(const Samples& row, typename Metric<Dim>::Sums& sums) const override;
  double summarise(std::span<const std::unique_ptr<typename Metric<Dim>::Sums>> tiles) override;
  void differentiate(const Samples& row, const Slopes& out) const override;
  double reference(Reference& all) const override;

 private:
  /// @throws SolverError when the moving image has no contrast.
  Correlation correlation(const CorrelationSums& sums) const;

  bool squared_;
  LeastVariances least_;
  Correlation correlation_;
};

extern template class NormalizedCrossCorrelation<2>;
extern template class NormalizedCrossCorrelation<3>;

}  // namespace crease
