#include "Registration/Elastic/RefinementLevels.h"

#include <algorithm>
#include <cmath>

#include "Images/Pyramid.h"
#include "Images/Smoothing.h"

namespace crease {

Image<float, 2> refinement_image(const Image<float, 2>& image, int shrink, double smoothing_mm,
                                 double unit) {
  // Each halving adds 3/4 of a squared pixel of its own level.
  const double pixel = image.raster().spacing.maxCoeff();
  const double variance = (shrink * shrink - 1) / 4.0 * pixel * pixel;
  const double rest = std::sqrt(std::max(0.0, smoothing_mm * smoothing_mm - variance));
  Image<float, 2> result =
      shrink > 1 ? crease::shrink(image, ShrinkFactors<2>{shrink, shrink}) : image;
  if (rest > 0) result = gaussian_smooth(result, rest);
  const auto factor = static_cast<float>(1 / unit);
  for (float& value : result.values()) value *= factor;
  return result;
}

}  // namespace crease
