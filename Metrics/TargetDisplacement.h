#pragma once

#include <array>
#include <string>
#include <vector>

#include "Metrics/Metric.h"

namespace crease {

/// Distance to a dense field of target points: fits a transform to an optical flow or to any other
/// displacement field, by weighted least squares.
///
///     E = 1/2 sum_x w(x) |T(x) - (x + f(x))|^2 dA,      F = w (T(x) - x - f(x)) dA,      G = w Id dA.
///
/// Source: speed of the start by optical flow; plain weighted least squares.
template <int Dim>
class TargetDisplacement final : public Metric<Dim> {
 public:
  /// @param raster   the fixed raster.
  /// @param field    f(x) in mm, one array per component, one entry per sample.
  /// @param weights  w(x) >= 0, one per sample.
  /// @throws InvalidInput when sizes differ or values are not finite.
  TargetDisplacement(const Raster<Dim>& raster, std::array<std::vector<float>, Dim> field,
                     std::vector<float> weights);

  std::string name() const override { return "target displacement"; }
  const Raster<Dim>& fixed_raster() const override { return raster_; }
  void evaluate_row(int pass, const MappedRow<Dim>& row, const ForceRow<Dim>& out,
                    typename Metric<Dim>::Sums& sums) const override;
  double finish_pass(int pass,
                     std::span<const std::unique_ptr<typename Metric<Dim>::Sums>> tiles) override;
  double evaluate(std::span<const Point<Dim>> mapped, std::span<Vector<Dim>> forces) const override;

 private:
  Raster<Dim> raster_;
  std::array<std::vector<float>, Dim> field_;
  std::vector<float> weights_;
};

extern template class TargetDisplacement<2>;
extern template class TargetDisplacement<3>;

}  // namespace crease
