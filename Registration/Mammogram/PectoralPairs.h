#pragma once

#include "Registration/Landmarks.h"
#include "Registration/Mammogram/MammogramAnatomy.h"

namespace crease {

/// Points on the edges of the pectoral muscle in two images that are equally far from the skin: the muscle is
/// stiff, and the film cuts it at the chest wall, there and then at different places. Pair k of n lies at k / (n + 1/2)
/// of the shorter line; names "pectoral 1", ..
///
/// None where an image shows no muscle, or its line does not begin within 3 mm of the skin.
/// @param count  pairs; fewer than 1: none.
Landmarks<2> pectoral_pairs(const MammogramAnatomy& fixed, const MammogramAnatomy& moving,
                            int count = 4);

/// The same for two lines from the skin to the chest wall, mm.
Landmarks<2> pectoral_pairs(const Polyline& fixed, const Polyline& moving, int count);

}  // namespace crease
