#pragma once

#include <algorithm>
#include <cmath>

#include "Images/IntensityRange.h"

namespace crease {

/// Bins 0 .. bins - 1 of intensities, with two bins of padding on either side, so that a cubic window never
/// leaves them: position 2 is the lowest intensity, bins - 3 the highest.
class IntensityBins {
 public:
  IntensityBins(const IntensityRange& range, int bins)
      : lower_(range.lower), per_intensity_((bins - 5) / range.width()), last_(bins - 3) {}

  double position(double intensity) const {
    return std::clamp((intensity - lower_) * per_intensity_ + 2, 2.0, static_cast<double>(last_));
  }
  double lower() const { return lower_; }
  int last() const { return last_; }  ///< the highest position
  /// d position / d intensity, inside the range.
  double per_intensity() const { return per_intensity_; }
  double per_intensity(double intensity) const {
    const double free = (intensity - lower_) * per_intensity_ + 2;
    return free >= 2 && free <= last_ ? per_intensity_ : 0;
  }

 private:
  double lower_, per_intensity_;
  int last_;
};

/// The cubic B-spline's values at the four bins first .. first + 3 about a position, and their derivatives
/// by the position.
struct CubicWindow {
  explicit CubicWindow(double position) : first(static_cast<int>(position) - 1) {
    constexpr double kSixth = 1.0 / 6;
    const double t = position - (first + 1), s = 1 - t;
    value[0] = s * s * s * kSixth;
    value[1] = 2.0 / 3 - t * t + 0.5 * t * t * t;
    value[2] = 2.0 / 3 - s * s + 0.5 * s * s * s;
    value[3] = t * t * t * kSixth;
    slope[0] = -0.5 * s * s;
    slope[1] = -2 * t + 1.5 * t * t;
    slope[2] = 2 * s - 1.5 * s * s;
    slope[3] = 0.5 * t * t;
  }
  int first;
  double value[4], slope[4];
};

}  // namespace crease
