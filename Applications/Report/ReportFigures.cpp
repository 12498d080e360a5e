#include "Applications/Report/ReportFigures.h"

#include <algorithm>
#include <cmath>

namespace crease {

std::uint8_t ReportScale::byte(double value) const {
  if (!std::isfinite(value)) return 0;
  double position = upper > lower ? (value - lower) / (upper - lower) : 0.5;
  if (logarithmic) {
    if (!(value > 0)) return 1;
    position = std::log(value / lower) / std::log(upper / lower);
  }
  return static_cast<std::uint8_t>(first +
                                   std::lround(std::clamp(position, 0.0, 1.0) * (255 - first)));
}

}  // namespace crease
