#pragma once

#include <memory>
#include <string>
#include <vector>

#include "Metrics/Metric.h"

namespace crease {

/// Several image pairs compared at once, whose fixed images lie on one raster:
///
///     E = sum_c w_c U_c E_c,     F = sum_c w_c U_c F_c,     G = sum_c w_c U_c G_c,
///
/// U_c the unit of metric c, so that weights compare squared differences whatever the metrics are. Samples are
/// mapped once per pass, and forces are summed before they are carried back. The passes of all metrics end
/// together: those of fewer passes begin later.
template <int Dim>
class MetricSum final : public Metric<Dim> {
 public:
  /// One of the metrics, and its weight, 0 or more.
  struct Channel {
    std::shared_ptr<Metric<Dim>> metric;
    double weight = 1;
  };

  /// @throws InvalidInput when there is no channel, one is a sum itself, a weight is negative or not finite, all are 0, or the
  /// fixed rasters differ.
  explicit MetricSum(std::vector<Channel> channels);

  /// "ssd" when all are that; otherwise all names: "ssd+mi".
  std::string name() const override;
  const Raster<Dim>& fixed_raster() const override {
    return channels_.front().metric->fixed_raster();
  }
  int num_passes() const override { return num_passes_; }
  int value_pass() const override;
  bool needs_map(int pass) const override;
  std::unique_ptr<typename Metric<Dim>::Sums> new_sums() const override;
  void evaluate_row(int pass, const MappedRow<Dim>& row, const ForceRow<Dim>& out,
                    typename Metric<Dim>::Sums& sums) const override;
  /// @throws SolverError as the metrics; the message names the channel.
  double finish_pass(int pass,
                     std::span<const std::unique_ptr<typename Metric<Dim>::Sums>> tiles) override;
  /// Mean over the channels that know one; nullopt where none does.
  std::optional<double> noise_power() const override;
  bool expects_similar_intensities() const override;
  double evaluate(std::span<const Point<Dim>> mapped, std::span<Vector<Dim>> forces) const override;

  const std::vector<Channel>& channels() const { return channels_; }
  /// E_c of the last evaluation by rows.
  const std::vector<double>& values() const { return values_; }

 private:
  /// The channel's own pass; below 0: it has not begun.
  int own_pass(const Channel& channel, int pass) const {
    return pass - (num_passes_ - channel.metric->num_passes());
  }
  static double factor(const Channel& channel) { return channel.weight * channel.metric->unit(); }

  std::vector<Channel> channels_;
  std::vector<double> values_;
  int num_passes_ = 1;
};

extern template class MetricSum<2>;
extern template class MetricSum<3>;

}  // namespace crease
