#include "Transforms/GaussRule.h"

#include <cmath>
#include <numbers>

#include "Core/Error.h"

namespace crease {

// Newton's method on the Legendre polynomial P_n from Chebyshev-like starts.
GaussRule gauss_rule(int num_points) {
  if (num_points < 1) {
    throw InvalidInput(message("gauss_rule: ", num_points, " points; at least 1 is needed."));
  }
  const int n = num_points;
  GaussRule rule;
  rule.points.resize(static_cast<std::size_t>(n));
  rule.weights.resize(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5));
    double slope = 0;
    for (int iteration = 0; iteration < 10; ++iteration) {
      double previous = 1, p = x;  // P_0, P_1
      for (int d = 2; d <= n; ++d) {
        const double next = ((2 * d - 1) * x * p - (d - 1) * previous) / d;
        previous = p;
        p = next;
      }
      slope = n * (x * p - previous) / (x * x - 1);
      x -= p / slope;
    }
    const auto at = static_cast<std::size_t>(n - 1 - i);
    rule.points[at] = 0.5 * (1 + x);
    rule.weights[at] = 1 / ((1 - x * x) * slope * slope);
  }
  return rule;
}

}  // namespace crease
