#pragma once

#include "Images/Image.h"

namespace crease {

/// The power of two that brings the grey values of one mammogram to the bit depth of another: 16 from 8 to 12
/// bits. 1 unless their ranges (intensity_unit) differ by a factor of nearly 3 or more, for films of different
/// years differ in gain as well, but hardly by that much.
double bit_depth_ratio(const Image<float, 2>& from, const Image<float, 2>& to);

}  // namespace crease
