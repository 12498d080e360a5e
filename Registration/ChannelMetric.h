#pragma once

#include <memory>
#include <span>
#include <vector>

#include "Registration/Channel.h"
#include "Registration/ImageLevels.h"

namespace crease {

/// A channel at all resolutions.
template <int Dim>
struct ChannelLevels {
  std::vector<ImageLevel<Dim>> levels;  ///< coarsest first
  MetricFactory<Dim> metric;
  double weight = 1;
};

/// Pyramids of all channels, with equally many levels: as many as all of them have.
template <int Dim>
std::vector<ChannelLevels<Dim>> channel_levels(std::span<const ChannelView<Dim>> channels,
                                               int levels, const ImageLevelOptions& options = {});

/// The metric of one level: of one channel of weight 1 its own, otherwise their MetricSum.
/// @param weights  of the fixed samples, for each channel.
template <int Dim>
std::shared_ptr<Metric<Dim>> channel_metric(std::span<const ChannelLevels<Dim>> channels,
                                            std::size_t level,
                                            std::vector<std::vector<float>> weights);

/// What a metric is made of.
template <int Dim>
struct ChannelValue {
  std::shared_ptr<Metric<Dim>> metric;
  double weight = 1;
  double value = 0;  ///< in its own unit
};

/// The channels of a MetricSum at its last evaluation by rows, or the metric itself.
/// @param value  of the metric then.
template <int Dim>
std::vector<ChannelValue<Dim>> channel_values(const std::shared_ptr<Metric<Dim>>& metric,
                                              double value);

/// Of two evaluations of the same metric.
template <int Dim>
std::vector<ChannelReport> channel_reports(std::span<const ChannelValue<Dim>> before,
                                           std::span<const ChannelValue<Dim>> after);

#define CREASE_DECLARE(Dim)                                                               \
  extern template std::vector<ChannelLevels<Dim>> channel_levels<Dim>(                    \
      std::span<const ChannelView<Dim>>, int, const ImageLevelOptions&);                  \
  extern template std::shared_ptr<Metric<Dim>> channel_metric<Dim>(                       \
      std::span<const ChannelLevels<Dim>>, std::size_t, std::vector<std::vector<float>>); \
  extern template std::vector<ChannelValue<Dim>> channel_values<Dim>(                     \
      const std::shared_ptr<Metric<Dim>>&, double);                                       \
  extern template std::vector<ChannelReport> channel_reports<Dim>(                        \
      std::span<const ChannelValue<Dim>>, std::span<const ChannelValue<Dim>>);
CREASE_DECLARE(2)
CREASE_DECLARE(3)
#undef CREASE_DECLARE

}  // namespace crease
