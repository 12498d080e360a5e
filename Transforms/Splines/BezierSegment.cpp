#include "Transforms/Splines/BezierSegment.h"

#include <algorithm>

namespace crease {
namespace {

using Values = BSplineSegment::Values;

/// From degree - 1 to degree; negative entries do not exist.
Values raised(const Values& lower, int degree, double s) {
  Values result{};
  result[0] = (1 - s) * lower[0];
  for (int r = 1; r < degree; ++r) result[r] = (1 - s) * lower[r] + s * lower[r - 1];
  result[degree] = s * lower[degree - 1];
  return result;
}

/// Derivatives of the polynomials of a degree >= 1 from what belongs to the degree below.
Values differentiated(const Values& lower, int degree) {
  Values result{};
  result[0] = -degree * lower[0];
  for (int r = 1; r < degree; ++r) result[r] = degree * (lower[r - 1] - lower[r]);
  result[degree] = degree * lower[degree - 1];
  return result;
}

}  // namespace

BSplineSegment bernstein_segment(int degree, double s, int derivatives) {
  std::array<Values, kMaxTensorDegree + 1> values{};
  values[0][0] = 1;
  for (int d = 1; d <= degree; ++d) values[d] = raised(values[d - 1], d, s);
  BSplineSegment result;
  result.value = values[degree];
  if (derivatives > 0 && degree > 0) result.first = differentiated(values[degree - 1], degree);
  if (derivatives > 1 && degree > 1) {
    result.second = differentiated(differentiated(values[degree - 2], degree - 1), degree);
  }
  return result;
}

// The knots are padded by repeating the outer ones: what stands there does not change this function,
// and all denominators span the interval.
BSplineSegment::Values bezier_ordinates(std::span<const double> knots, double begin, double end) {
  const int n = static_cast<int>(knots.size()) - 2;
  std::array<double, 3 * kMaxTensorDegree + 2> padded;
  for (int k = 0; k < 3 * n + 2; ++k) padded[k] = knots[std::clamp(k - n, 0, n + 1)];
  int span = n;
  while (span < 2 * n && padded[span + 1] <= begin) ++span;
  Values ordinates{};
  if (begin < knots.front() || end > knots.back()) return ordinates;
  for (int r = 0; r <= n; ++r) {
    // c[k] belongs to the function span - n + k; only function n is ours.
    std::array<double, kMaxTensorDegree + 1> c{};
    c[2 * n - span] = 1;
    for (int level = 1; level <= n; ++level) {
      const double u = level <= n - r ? begin : end;
      for (int k = n; k >= level; --k) {
        const int i = span - n + k;
        const double share = (u - padded[i]) / (padded[i + n + 1 - level] - padded[i]);
        c[k] = (1 - share) * c[k - 1] + share * c[k];
      }
    }
    ordinates[r] = c[n];
  }
  return ordinates;
}

BezierJet bezier_jet(const Values& ordinates, const BSplineSegment& bernstein, double length) {
  BezierJet jet;
  for (std::size_t r = 0; r < ordinates.size(); ++r) {
    jet.value += ordinates[r] * bernstein.value[r];
    jet.first += ordinates[r] * bernstein.first[r];
    jet.second += ordinates[r] * bernstein.second[r];
  }
  jet.first /= length;
  jet.second /= length * length;
  return jet;
}

}  // namespace crease
