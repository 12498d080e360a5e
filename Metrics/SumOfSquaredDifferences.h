#pragma once

#include <memory>
#include <string>
#include <vector>

#include "Metrics/Metric.h"
#include "Metrics/MetricInput.h"

namespace crease {

/// Sum of squared differences: for images of the same modality.
///
///     E = 1/2 sum_x w(x) m(T(x)) (I_m(T(x)) - I_f(x))^2 dA,
///     F = w m (I_m - I_f) grad I_m dA + 1/2 w (I_m - I_f)^2 grad m dA,      G = w m grad I_m grad I_m^T dA,
///
/// with the sample weights w of the fixed image, the weight m of the moving mask (1 without one), the
/// sample volume dA (mm^2 or mm^3) and Gauss-Newton's curvature G. Samples that leave the moving image
/// are compared with its border value and feel no force, so that their number never jumps.
///
/// Source: dissertation, (3.4); J. Modersitzki, "Numerical Methods for Image Registration", 2004.
template <int Dim>
class SumOfSquaredDifferences final : public Metric<Dim> {
 public:
  /// @throws InvalidInput when no sample has a weight or an image is constant where it counts.
  explicit SumOfSquaredDifferences(MetricInput<Dim> input);

  std::string name() const override { return "ssd"; }
  const Raster<Dim>& fixed_raster() const override { return input_.fixed.raster(); }
  void evaluate_row(int pass, const MappedRow<Dim>& row, const ForceRow<Dim>& out,
                    typename Metric<Dim>::Sums& sums) const override;
  double finish_pass(int pass,
                     std::span<const std::unique_ptr<typename Metric<Dim>::Sums>> tiles) override;
  bool expects_similar_intensities() const override { return true; }
  double evaluate(std::span<const Point<Dim>> mapped, std::span<Vector<Dim>> forces) const override;

 private:
  MetricInput<Dim> input_;
};

extern template class SumOfSquaredDifferences<2>;
extern template class SumOfSquaredDifferences<3>;

}  // namespace crease
