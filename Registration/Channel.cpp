#include "Registration/Channel.h"

#include <cmath>

#include "Core/Error.h"
#include "Images/ImageFile.h"
#include "Images/IntensityRange.h"
#include "Images/RasterCheck.h"
#include "Images/Resample.h"

namespace crease {
namespace {

template <typename Image>
const Image* pointer(const std::optional<Image>& image) {
  return image ? &*image : nullptr;
}

template <int Dim>
Image<float, Dim> scaled(const Image<float, Dim>& image, double factor) {
  Image<float, Dim> result = image;
  for (float& v : result.values()) v *= static_cast<float>(factor);
  return result;
}

/// A mask in the space of another grid: of its samples' nearest pixels.
template <int Dim>
Mask<Dim> mask_on(const Mask<Dim>& mask, const Raster<Dim>& raster) {
  if (same_raster(mask.raster(), raster)) return mask;
  return resample_nearest(mask, raster, PointMap<Dim>([](const Point<Dim>& x) { return x; }));
}

}  // namespace

template <int Dim>
std::vector<ChannelView<Dim>> views(std::span<const Channel<Dim>> channels) {
  std::vector<ChannelView<Dim>> result;
  for (const Channel<Dim>& channel : channels) {
    result.push_back({&channel.fixed, &channel.moving, pointer(channel.fixed_mask),
                      pointer(channel.moving_mask), channel.metric, channel.weight});
  }
  return result;
}

template <int Dim>
void check_channel(const Channel<Dim>& channel, const Raster<Dim>& fixed, std::size_t number) {
  const std::string name = message("channel ", number);
  if (channel.fixed.empty() || channel.moving.empty()) {
    throw InvalidInput(
        message(name, ": the ", channel.fixed.empty() ? "fixed" : "moving", " image is empty"));
  }
  check_finite(channel.fixed, name + ": the fixed image");
  check_finite(channel.moving, name + ": the moving image");
  if (!(channel.weight >= 0) || !std::isfinite(channel.weight)) {
    throw InvalidInput(message(name, " has the weight ", channel.weight,
                               "; it must be a finite number, 0 or more"));
  }
  if (channel.metric == nullptr) throw InvalidInput(message(name, " has no metric"));
  if (same_raster(channel.fixed.raster(), fixed)) return;
  throw InvalidInput(message(
      "the fixed images of channels 1 and ", number, " have different grids: ", describe(fixed),
      " and ", describe(channel.fixed.raster()), "; resample one onto the other's grid"));
}

template <int Dim>
std::vector<Channel<Dim>> normalised(std::span<const ChannelView<Dim>> channels) {
  std::vector<Channel<Dim>> result;
  for (const ChannelView<Dim>& view : channels) {
    Channel<Dim> channel;
    channel.metric = view.metric;
    channel.weight = view.weight;
    const ChannelView<Dim>& first = channels.front();
    const Mask<Dim>* fixed_mask = view.fixed_mask ? view.fixed_mask : first.fixed_mask;
    const Mask<Dim>* moving_mask = view.moving_mask ? view.moving_mask : first.moving_mask;
    if (fixed_mask != nullptr) channel.fixed_mask = *fixed_mask;
    if (moving_mask != nullptr) {
      channel.moving_mask =
          view.moving_mask ? *moving_mask : mask_on(*moving_mask, view.moving->raster());
    }
    const double unit = intensity_unit(*view.fixed, fixed_mask);
    channel.fixed = scaled(*view.fixed, unit > 0 ? 1 / unit : 1);
    channel.moving = scaled(*view.moving, unit > 0 ? 1 / unit : 1);
    result.push_back(std::move(channel));
  }
  return result;
}

#define CREASE_INSTANTIATE(Dim)                                                           \
  template std::vector<ChannelView<Dim>> views<Dim>(std::span<const Channel<Dim>>);       \
  template void check_channel<Dim>(const Channel<Dim>&, const Raster<Dim>&, std::size_t); \
  template std::vector<Channel<Dim>> normalised<Dim>(std::span<const ChannelView<Dim>>);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease
