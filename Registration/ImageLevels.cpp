#include "Registration/ImageLevels.h"

#include <algorithm>

#include "Images/Pyramid.h"
#include "Images/Smoothing.h"

namespace crease {
namespace {

constexpr int kSmallestAxis = 16;

/// Levels that leave the longest axis of both images 16 samples or more.
template <int Dim>
int possible_levels(const Raster<Dim>& fixed, const Raster<Dim>& moving, int levels) {
  const auto longest = [](const Raster<Dim>& raster, int level) {
    const auto size = shrink(raster, shrink_factors(raster, level)).size;
    return *std::max_element(size.begin(), size.end());
  };
  int possible = 1;
  while (possible < levels && longest(fixed, possible) >= kSmallestAxis &&
         longest(moving, possible) >= kSmallestAxis) {
    ++possible;
  }
  return possible;
}

template <int Dim>
std::vector<float> sample_weights(const Mask<Dim>* mask, const ShrinkFactors<Dim>& factors,
                                  const Raster<Dim>& raster) {
  std::vector<float> weights(static_cast<std::size_t>(raster.num_samples()), 1.0f);
  if (mask == nullptr) return weights;
  const Mask<Dim> coarse = shrink_mask(*mask, factors);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    weights[i] = coarse.values()[i] != 0 ? 1.0f : 0.0f;
  }
  return weights;
}

/// 0 and 1 with a ramp of about two pixels between, linear in between.
template <int Dim>
std::shared_ptr<const Interpolator<Dim>> blurred_mask(const Mask<Dim>& mask) {
  Image<float, Dim> soft(mask.raster());
  for (std::size_t i = 0; i < soft.values().size(); ++i) {
    soft.values()[i] = mask.values()[i] != 0 ? 1.0f : 0.0f;
  }
  return make_interpolator(smooth_121(smooth_121(soft)), InterpolationKind::kLinear);
}

}  // namespace

template <int Dim>
std::vector<ImageLevel<Dim>> image_levels(const Image<float, Dim>& fixed,
                                          const Image<float, Dim>& moving,
                                          const Mask<Dim>* fixed_mask, const Mask<Dim>* moving_mask,
                                          int levels, const ImageLevelOptions& options) {
  const int count = possible_levels(fixed.raster(), moving.raster(), levels);
  std::vector<ImageLevel<Dim>> pyramid;
  Image<float, Dim> fixed_level = fixed, moving_level = moving;
  for (int l = 0; l < count; ++l) {
    const auto fixed_factors = shrink_factors(fixed.raster(), l);
    const auto moving_factors = shrink_factors(moving.raster(), l);
    if (l > 0) {
      fixed_level = shrink(fixed_level, shrink_factors(fixed_level.raster(), 1));
      moving_level = shrink(moving_level, shrink_factors(moving_level.raster(), 1));
    }
    const bool smooth = l == 0 && options.smooth_finest;
    ImageLevel<Dim> level;
    level.shrink = *std::max_element(fixed_factors.begin(), fixed_factors.end());
    level.fixed = smooth ? smooth_121(fixed_level) : fixed_level;
    level.weights = sample_weights(fixed_mask, fixed_factors, level.fixed.raster());
    level.moving =
        make_interpolator(smooth ? smooth_121(moving_level) : moving_level, options.interpolation);
    if (moving_mask != nullptr) {
      const Mask<Dim> mask = shrink_mask(*moving_mask, moving_factors);
      level.moving_mask = blurred_mask(mask);
      if (std::ranges::any_of(mask.values(), [](auto set) { return set != 0; })) {
        level.moving_range = level.moving->coefficient_range(mask);
      }
    }
    pyramid.push_back(std::move(level));
  }
  std::reverse(pyramid.begin(), pyramid.end());
  return pyramid;
}

template std::vector<ImageLevel<2>> image_levels<2>(const Image<float, 2>&, const Image<float, 2>&,
                                                    const Mask<2>*, const Mask<2>*, int,
                                                    const ImageLevelOptions&);
template std::vector<ImageLevel<3>> image_levels<3>(const Image<float, 3>&, const Image<float, 3>&,
                                                    const Mask<3>*, const Mask<3>*, int,
                                                    const ImageLevelOptions&);

}  // namespace crease
