#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "Images/Image.h"
#include "Registration/MetricFactories.h"

namespace crease {

/// One of several image pairs that are compared at once, E_I = sum_c w_c E_c (MetricSum): another contrast, a
/// map of textures, edges or distances. All fixed images lie on one grid; moving images may lie on any.
template <int Dim>
struct Channel {
  Image<float, Dim> fixed, moving;
  MetricFactory<Dim> metric = ssd<Dim>();
  double weight = 1;  ///< w_c, 0 or more
  /// Without: those of the first pair.
  std::optional<Mask<Dim>> fixed_mask = std::nullopt, moving_mask = std::nullopt;
};

/// How alike the images of one channel are, by its own metric.
struct ChannelReport {
  std::string name;  ///< of the metric: "ssd"
  double weight = 1;
  double before = 0, after = 0;
};

/// A channel's images where they lie; they must outlive this.
template <int Dim>
struct ChannelView {
  const Image<float, Dim>* fixed = nullptr;
  const Image<float, Dim>* moving = nullptr;
  const Mask<Dim>* fixed_mask = nullptr;  ///< null: everything counts
  const Mask<Dim>* moving_mask = nullptr;
  MetricFactory<Dim> metric = ssd<Dim>();
  double weight = 1;
};
template <int Dim>
std::vector<ChannelView<Dim>> views(std::span<const Channel<Dim>> channels);

/// Checks channel number `number` (from 1) beside the first one's fixed grid.
/// @throws InvalidInput when an image is empty, has values that are not finite, the weight is negative, or the
/// fixed image lies on another grid; the message names the channel, or both grids.
template <int Dim>
void check_channel(const Channel<Dim>& channel, const Raster<Dim>& fixed, std::size_t number);

/// The channels with intensities divided by their fixed images' 1..99 % range in the mask, so that weights do
/// not depend on units, and with masks of the first where they have none of their own.
template <int Dim>
std::vector<Channel<Dim>> normalised(std::span<const ChannelView<Dim>> channels);

#define CREASE_DECLARE(Dim)                                                                      \
  extern template std::vector<ChannelView<Dim>> views<Dim>(std::span<const Channel<Dim>>);       \
  extern template void check_channel<Dim>(const Channel<Dim>&, const Raster<Dim>&, std::size_t); \
  extern template std::vector<Channel<Dim>> normalised<Dim>(std::span<const ChannelView<Dim>>);
CREASE_DECLARE(2)
CREASE_DECLARE(3)
#undef CREASE_DECLARE

}  // namespace crease
