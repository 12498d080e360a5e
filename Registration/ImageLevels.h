#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "Images/Image.h"
#include "Images/MakeInterpolator.h"
#include "Metrics/MetricInput.h"

namespace crease {

/// Both images at one resolution.
template <int Dim>
struct ImageLevel {
  int shrink = 1;  ///< of the fixed image, per axis
  Image<float, Dim> fixed;
  std::vector<float> weights;  ///< of the fixed samples: 1 in the mask, 0 outside
  std::shared_ptr<const Interpolator<Dim>> moving;
  std::shared_ptr<const Interpolator<Dim>> moving_mask;  ///< null without a mask
  std::optional<IntensityRange> moving_range;  ///< of the moving image's coefficients in it
};

/// What a metric takes of a level, with other weights of the samples.
template <int Dim>
MetricInput<Dim> metric_input(const ImageLevel<Dim>& level, std::vector<float> weights) {
  return {level.fixed, std::move(weights), level.moving, level.moving_mask, level.moving_range};
}

/// How levels are filtered and read.
struct ImageLevelOptions {
  InterpolationKind interpolation = InterpolationKind::kCubic;
  /// Low-pass [1 2 1]/4 of both images at the finest level: the gradient of a noisy moving image
  /// correlates with its noise, which biases the result more than the filter does.
  bool smooth_finest = false;
};

/// A pyramid of both images, coarsest level first, a factor of two each. Fewer levels than asked for
/// when an axis of either image would fall below 16 samples (an axis of fewer samples is kept).
/// @param fixed_mask, moving_mask  null: everything counts. A pixel of a coarser level counts when more
/// than half of it does; the moving mask is blurred by a pixel, so that it can be differentiated.
template <int Dim>
std::vector<ImageLevel<Dim>> image_levels(const Image<float, Dim>& fixed,
                                          const Image<float, Dim>& moving,
                                          const Mask<Dim>* fixed_mask, const Mask<Dim>* moving_mask,
                                          int levels, const ImageLevelOptions& options = {});

extern template std::vector<ImageLevel<2>> image_levels<2>(const Image<float, 2>&,
                                                           const Image<float, 2>&, const Mask<2>*,
                                                           const Mask<2>*, int,
                                                           const ImageLevelOptions&);
extern template std::vector<ImageLevel<3>> image_levels<3>(const Image<float, 3>&,
                                                           const Image<float, 3>&, const Mask<3>*,
                                                           const Mask<3>*, int,
                                                           const ImageLevelOptions&);

}  // namespace crease
