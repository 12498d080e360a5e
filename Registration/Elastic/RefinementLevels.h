#pragma once

#include "Images/Image.h"

namespace crease {

/// One image of a level: shrunk, and smoothed by a Gaussian that counts in what shrinking has smoothed already.
/// @param shrink  a power of two.
/// @param smoothing_mm  standard deviation wanted; less than the filters of shrinking leave cannot be had.
/// @param unit  what is divided by.
Image<float, 2> refinement_image(const Image<float, 2>& image, int shrink, double smoothing_mm,
                                 double unit);

}  // namespace crease
