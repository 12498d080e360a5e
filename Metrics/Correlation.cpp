#include "Metrics/Correlation.h"

#include <cmath>

namespace crease {

CorrelationSums& CorrelationSums::operator+=(const CorrelationSums& other) {
  w += other.w;
  a += other.a;
  b += other.b;
  aa += other.aa;
  bb += other.bb;
  ab += other.ab;
  return *this;
}

Correlation correlate(const CorrelationSums& sums, bool squared, const LeastVariances& least) {
  Correlation result;
  if (!(sums.w > 0)) return result;
  result.mean_a = sums.a / sums.w;
  result.mean_b = sums.b / sums.w;
  const double aa = sums.aa - sums.a * result.mean_a;
  const double bb = sums.bb - sums.b * result.mean_b;
  const double ab = sums.ab - sums.a * result.mean_b;
  if (!(aa > least.a * sums.w) || !(bb > least.b * sums.w)) return result;
  result.has_contrast = true;
  const double norm = std::sqrt(aa * bb), ncc = ab / norm;
  // E = 1 - ncc or 1 - ncc^2; `outer` is dE/dncc.
  const double outer = squared ? -2 * ncc : -1;
  result.value = squared ? 1 - ncc * ncc : 1 - ncc;
  result.by_ab = outer / norm;
  result.by_aa = -0.5 * outer * ncc / aa;
  result.by_bb = -0.5 * outer * ncc / bb;
  result.by_a = result.by_ab;
  result.by_b = 2 * result.by_bb;
  result.curvature = (squared ? 2 * ncc * ncc : 1) / bb;
  return result;
}

}  // namespace crease
