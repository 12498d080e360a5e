#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace crease::testing {

/// How far the central difference of f at 0 is from the slope, relative to it.
inline double slope_error(const std::function<double(double)>& f, double slope, double step) {
  return std::abs((f(step) - f(-step)) / (2 * step) - slope) / std::abs(slope);
}

/// Central differences of f at 0, a smooth function along a line, against its slope: the relative error is
/// below 1e-6 at step 1e-5, and falls a hundredfold with each tenfold smaller step until 1e-7, where
/// rounding begins. A wrong slope fails both; one that is wrong by little, the second.
/// @param first_step  small enough that the error is that of the third derivative alone.
inline void expect_slope(const std::function<double(double)>& f, double slope,
                         const std::string& what, double first_step = 1e-2) {
  double previous = std::numeric_limits<double>::quiet_NaN();
  double step = first_step;
  while (step > 0.5e-5) {
    const double error = slope_error(f, slope, step);
    // A twentieth less than a hundredfold: derivatives of higher order.
    if (previous > 1e-7)
      EXPECT_LT(error, std::max(1e-7, previous / 95)) << what << ", step " << step;
    previous = error;
    step /= 10;
  }
  EXPECT_LT(slope_error(f, slope, 1e-5), 1e-6) << what;
}

}  // namespace crease::testing
