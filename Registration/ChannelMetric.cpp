#include "Registration/ChannelMetric.h"

#include <algorithm>

#include "Metrics/MetricSum.h"

namespace crease {

template <int Dim>
std::vector<ChannelLevels<Dim>> channel_levels(std::span<const ChannelView<Dim>> channels,
                                               int levels, const ImageLevelOptions& options) {
  std::vector<ChannelLevels<Dim>> result;
  std::size_t common = static_cast<std::size_t>(levels);
  for (const ChannelView<Dim>& view : channels) {
    result.push_back({image_levels(*view.fixed, *view.moving, view.fixed_mask, view.moving_mask,
                                   levels, options),
                      view.metric, view.weight});
    common = std::min(common, result.back().levels.size());
  }
  for (auto& channel : result) {
    auto& own = channel.levels;
    own.erase(own.begin(), own.end() - static_cast<std::ptrdiff_t>(common));
  }
  return result;
}

template <int Dim>
std::shared_ptr<Metric<Dim>> channel_metric(std::span<const ChannelLevels<Dim>> channels,
                                            std::size_t level,
                                            std::vector<std::vector<float>> weights) {
  std::vector<typename MetricSum<Dim>::Channel> parts;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const ChannelLevels<Dim>& channel = channels[c];
    parts.push_back({channel.metric(metric_input(channel.levels[level], std::move(weights[c]))),
                     channel.weight});
  }
  if (parts.size() == 1 && parts.front().weight == 1) return parts.front().metric;
  return std::make_shared<MetricSum<Dim>>(std::move(parts));
}

template <int Dim>
std::vector<ChannelValue<Dim>> channel_values(const std::shared_ptr<Metric<Dim>>& metric,
                                              double value) {
  const auto* sum = dynamic_cast<const MetricSum<Dim>*>(metric.get());
  if (sum == nullptr) return {{metric, 1, value}};
  std::vector<ChannelValue<Dim>> result;
  for (std::size_t c = 0; c < sum->channels().size(); ++c) {
    const auto& channel = sum->channels()[c];
    result.push_back({channel.metric, channel.weight, sum->values()[c]});
  }
  return result;
}

template <int Dim>
std::vector<ChannelReport> channel_reports(std::span<const ChannelValue<Dim>> before,
                                           std::span<const ChannelValue<Dim>> after) {
  std::vector<ChannelReport> result;
  for (std::size_t c = 0; c < before.size(); ++c) {
    result.push_back({before[c].metric->name(), before[c].weight, before[c].value, after[c].value});
  }
  return result;
}

#define CREASE_INSTANTIATE(Dim)                                                                    \
  template std::vector<ChannelLevels<Dim>> channel_levels<Dim>(std::span<const ChannelView<Dim>>,  \
                                                               int, const ImageLevelOptions&);     \
  template std::shared_ptr<Metric<Dim>> channel_metric<Dim>(                                       \
      std::span<const ChannelLevels<Dim>>, std::size_t, std::vector<std::vector<float>>);          \
  template std::vector<ChannelValue<Dim>> channel_values<Dim>(const std::shared_ptr<Metric<Dim>>&, \
                                                              double);                             \
  template std::vector<ChannelReport> channel_reports<Dim>(std::span<const ChannelValue<Dim>>,     \
                                                           std::span<const ChannelValue<Dim>>);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease
