#include "Metrics/MetricSum.h"

#include <algorithm>
#include <cmath>

#include "Core/Cpu.h"
#include "Core/Error.h"
#include "Images/RasterCheck.h"
#include "Metrics/IntensityKernel.h"

namespace crease {
namespace {

/// Forces and curvature of one channel along a row; kept by each thread for its next row.
template <int Dim>
struct ChannelRow {
  std::array<std::vector<float>, Dim> force;
  std::array<std::vector<float>, Dim*(Dim + 1) / 2> curvature;

  ForceRow<Dim> clear(int width, const ForceRow<Dim>& wanted) {
    constexpr int kBeyond = 32;  // entries that a metric may write
    const auto size = static_cast<std::size_t>(width + kBeyond);
    ForceRow<Dim> row;
    for (std::size_t a = 0; a < force.size(); ++a) {
      if (wanted.force[a] == nullptr) continue;
      force[a].resize(size);
      row.force[a] = force[a].data();
    }
    for (std::size_t k = 0; k < curvature.size(); ++k) {
      if (wanted.curvature[k] == nullptr) continue;
      curvature[k].assign(size / 4, 0.0f);
      row.curvature[k] = curvature[k].data();
    }
    return row;
  }
};

template <int Dim>
ChannelRow<Dim>& channel_row() {
  static thread_local ChannelRow<Dim> instance;
  return instance;
}

void add_scaled(const float* from, float factor, float* to, int begin, int end) {
  cpu_has_avx2() ? avx2::add_scaled(from + begin, factor, to + begin, end - begin)
                 : baseline::add_scaled(from + begin, factor, to + begin, end - begin);
}

/// Sums of a tile, one for each channel.
template <int Dim>
struct SumsOfChannels final : Metric<Dim>::Sums {
  std::vector<std::unique_ptr<typename Metric<Dim>::Sums>> channels;
};

}  // namespace

template <int Dim>
MetricSum<Dim>::MetricSum(std::vector<Channel> channels)
    : channels_(std::move(channels)), values_(channels_.size(), 0.0) {
  if (channels_.empty()) throw InvalidInput("sum of metrics: there is no channel");
  double sum = 0;
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const auto& [metric, weight] = channels_[c];
    if (metric == nullptr) throw InvalidInput(message("channel ", c + 1, " has no metric"));
    if (dynamic_cast<const MetricSum*>(metric.get()) != nullptr) {
      throw InvalidInput(message("channel ", c + 1, " is a sum itself; list its channels instead"));
    }
    if (!(weight >= 0) || !std::isfinite(weight)) {
      throw InvalidInput(message("channel ", c + 1, " has the weight ", weight,
                                 "; weights are finite and not negative"));
    }
    sum += weight;
    if (!same_raster(metric->fixed_raster(), fixed_raster())) {
      throw InvalidInput(message("the fixed images of channels 1 and ", c + 1,
                                 " have different grids: ", describe(fixed_raster()), " and ",
                                 describe(metric->fixed_raster()),
                                 "; resample one onto the other's"));
    }
    num_passes_ = std::max(num_passes_, metric->num_passes());
  }
  if (!(sum > 0)) throw InvalidInput("all channels have the weight 0; give one more");
}

template <int Dim>
std::string MetricSum<Dim>::name() const {
  std::string names;
  bool same = true;
  for (const Channel& channel : channels_) {
    same = same && channel.metric->name() == channels_.front().metric->name();
    names += (names.empty() ? "" : "+") + channel.metric->name();
  }
  return same ? channels_.front().metric->name() : names;
}

template <int Dim>
int MetricSum<Dim>::value_pass() const {
  int last = 0;
  for (const Channel& channel : channels_) {
    last = std::max(last, channel.metric->value_pass() - own_pass(channel, 0));
  }
  return last;
}

template <int Dim>
bool MetricSum<Dim>::needs_map(int pass) const {
  return std::ranges::any_of(channels_, [&](const Channel& channel) {
    const int own = own_pass(channel, pass);
    return own >= 0 && channel.metric->needs_map(own);
  });
}

template <int Dim>
std::unique_ptr<typename Metric<Dim>::Sums> MetricSum<Dim>::new_sums() const {
  auto sums = std::make_unique<SumsOfChannels<Dim>>();
  for (const Channel& channel : channels_) sums->channels.push_back(channel.metric->new_sums());
  return sums;
}

template <int Dim>
void MetricSum<Dim>::evaluate_row(int pass, const MappedRow<Dim>& row, const ForceRow<Dim>& out,
                                  typename Metric<Dim>::Sums& sums) const {
  auto& own_sums = static_cast<SumsOfChannels<Dim>&>(sums).channels;
  for (float* force : out.force) {
    if (force != nullptr) {
      std::fill(force + row.begin / 4 * 4, force + (row.end + 3) / 4 * 4, 0.0f);
    }
  }
  const int width = fixed_raster().size[0];
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const int own = own_pass(channels_[c], pass);
    if (own < 0) continue;
    const ForceRow<Dim> found = channel_row<Dim>().clear(width, out);
    channels_[c].metric->evaluate_row(own, row, found, *own_sums[c]);
    if (row.begin >= row.end) continue;
    const auto scale = static_cast<float>(factor(channels_[c]));
    for (std::size_t a = 0; a < out.force.size(); ++a) {
      if (out.force[a] != nullptr) {
        add_scaled(found.force[a], scale, out.force[a], row.begin, row.end);
      }
    }
    for (std::size_t k = 0; k < out.curvature.size(); ++k) {
      if (out.curvature[k] != nullptr) {
        add_scaled(found.curvature[k], scale, out.curvature[k], row.begin / 4, (row.end + 3) / 4);
      }
    }
  }
}

template <int Dim>
double MetricSum<Dim>::finish_pass(
    int pass, std::span<const std::unique_ptr<typename Metric<Dim>::Sums>> tiles) {
  double value = 0;
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const int own = own_pass(channels_[c], pass);
    if (own < 0) continue;
    std::vector<std::unique_ptr<typename Metric<Dim>::Sums>> of_channel;
    for (const auto& tile : tiles) {
      of_channel.push_back(std::move(static_cast<SumsOfChannels<Dim>&>(*tile).channels[c]));
    }
    try {
      values_[c] = channels_[c].metric->finish_pass(own, of_channel);
    } catch (const SolverError& error) {
      throw SolverError(message("channel ", c + 1, ": ", error.what()));
    }
    value += factor(channels_[c]) * values_[c];
  }
  return value;
}

template <int Dim>
std::optional<double> MetricSum<Dim>::noise_power() const {
  double sum = 0, weights = 0;
  for (const Channel& channel : channels_) {
    const auto power = channel.metric->noise_power();
    if (!power) continue;
    sum += channel.weight * *power;
    weights += channel.weight;
  }
  return weights > 0 ? std::optional(sum / weights) : std::nullopt;
}

template <int Dim>
bool MetricSum<Dim>::expects_similar_intensities() const {
  return std::ranges::any_of(channels_, [](const Channel& channel) {
    return channel.metric->expects_similar_intensities();
  });
}

template <int Dim>
double MetricSum<Dim>::evaluate(std::span<const Point<Dim>> mapped,
                                std::span<Vector<Dim>> forces) const {
  double value = 0;
  std::vector<Vector<Dim>> own(forces.size());
  for (auto& force : forces) force.setZero();
  for (const Channel& channel : channels_) {
    value += factor(channel) * channel.metric->evaluate(mapped, own);
    for (std::size_t i = 0; i < own.size(); ++i) forces[i] += factor(channel) * own[i];
  }
  return value;
}

template class MetricSum<2>;
template class MetricSum<3>;

}  // namespace crease
