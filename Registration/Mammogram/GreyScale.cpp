#include "Registration/Mammogram/GreyScale.h"

#include <cmath>

#include "Images/IntensityRange.h"

namespace crease {

double bit_depth_ratio(const Image<float, 2>& from, const Image<float, 2>& to) {
  const double ratio = intensity_unit(to) / intensity_unit(from);
  if (!(ratio > 0) || !std::isfinite(ratio)) return 1;  // a constant image
  const double bits = std::round(std::log2(ratio));
  return std::abs(bits) < 2 ? 1.0 : std::exp2(bits);
}

}  // namespace crease
