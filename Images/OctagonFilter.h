#pragma once

#include "Images/Image.h"

namespace crease {

/// What lies beyond a mask's border.
enum class Outside { kBackground, kForeground };

// Morphology with the regular octagon |x|, |y| <= r, |x| + |y| <= round(1.4 r) (pixels), the sum of a square and
// a diamond, so that the cost grows with r, not with its square.

/// Dilation, then erosion: fills gaps narrower than the octagon.
Mask<2> closed_by_octagon(const Mask<2>& mask, int radius, Outside outside);
/// Erosion, then dilation: takes away what the octagon does not fit into.
Mask<2> opened_by_octagon(const Mask<2>& mask, int radius, Outside outside);

}  // namespace crease
