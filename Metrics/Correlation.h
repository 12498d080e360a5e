#pragma once

namespace crease {

/// Weighted sums over samples of two intensities.
struct CorrelationSums {
  double w = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  CorrelationSums& operator+=(const CorrelationSums& other);
};

/// The value E of a correlation and its derivatives: dE/db_x = w (by_a (a_x - mean_a) + by_b (b_x - mean_b)),
/// dE/dw_x = weight_slope(a_x, b_x), and the curvature w c by b_x.
struct Correlation {
  double value = 1;
  bool has_contrast = false;
  double mean_a = 0, mean_b = 0;
  double by_a = 0, by_b = 0;
  double by_aa = 0, by_bb = 0,
         by_ab = 0;  ///< of products of what is left of a and b without their means
  double curvature = 0;
  double weight_slope(double a, double b) const {
    const double x = a - mean_a, y = b - mean_b;
    return by_aa * x * x + by_bb * y * y + by_ab * x * y;
  }
};

/// E = 1 - s_ab / (s_aa s_bb)^1/2, or 1 - s_ab^2 / (s_aa s_bb) when squared, s sums of products of deviations.
/// Without contrast, a variance not above the least one given, E = 1 and there are no slopes.
struct LeastVariances {
  double a = 0, b = 0;
};
Correlation correlate(const CorrelationSums& sums, bool squared, const LeastVariances& least);

}  // namespace crease
