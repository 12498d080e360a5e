#pragma once

#include <span>

#include "Images/Image.h"

namespace crease {

/// Filters an image along one axis, with the outer pixels repeated beyond the border:
///
///     out(i) = sum_t weights[t] in(step * i + t - before),    i = 0 .. ceil(n / step) - 1.
///
/// Only pixels: the caller says on which raster the result lies.
/// @param result  its size is the image's, with ceil(n / step) along the axis.
template <int Dim>
Image<float, Dim> filter_axis(const Image<float, Dim>& image, int axis,
                              std::span<const float> weights, int before, int step,
                              const Raster<Dim>& result);

extern template Image<float, 2> filter_axis<2>(const Image<float, 2>&, int, std::span<const float>,
                                               int, int, const Raster<2>&);
extern template Image<float, 3> filter_axis<3>(const Image<float, 3>&, int, std::span<const float>,
                                               int, int, const Raster<3>&);

}  // namespace crease
