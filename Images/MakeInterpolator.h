#pragma once

#include <memory>

#include "Images/Interpolator.h"

namespace crease {

enum class InterpolationKind { kLinear, kCubic };

/// The interpolator of that kind for the image, which is not needed afterwards.
/// @throws InvalidInput when pixels are not finite.
template <int Dim>
std::unique_ptr<Interpolator<Dim>> make_interpolator(
    const Image<float, Dim>& image, InterpolationKind kind = InterpolationKind::kCubic);

extern template std::unique_ptr<Interpolator<2>> make_interpolator<2>(const Image<float, 2>&,
                                                                      InterpolationKind);
extern template std::unique_ptr<Interpolator<3>> make_interpolator<3>(const Image<float, 3>&,
                                                                      InterpolationKind);

}  // namespace crease
