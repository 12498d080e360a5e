#include "Metrics/MetricInput.h"

#include <cmath>

namespace crease {

template <int Dim>
void check(const MetricInput<Dim>& input) {
  const auto& fixed = input.fixed.values();
  if (input.moving == nullptr) throw InvalidInput("metric: there is no moving image");
  if (input.weights.size() != fixed.size()) {
    throw InvalidInput(message("metric: ", input.weights.size(), " sample weights for ",
                               fixed.size(), " samples of the fixed image"));
  }
  double sum = 0;
  float lowest = 0, highest = 0;
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    const float w = input.weights[i];
    if (!(w >= 0) || !std::isfinite(w)) {
      throw InvalidInput(message("metric: the weight of sample ", i, " is ", w,
                                 "; weights are finite and not negative"));
    }
    if (w == 0) continue;
    if (!std::isfinite(fixed[i])) {
      throw InvalidInput(message("metric: sample ", i, " of the fixed image is ", fixed[i],
                                 "; replace or mask values that are not finite"));
    }
    lowest = sum == 0 ? fixed[i] : std::min(lowest, fixed[i]);
    highest = sum == 0 ? fixed[i] : std::max(highest, fixed[i]);
    sum += w;
  }
  if (sum == 0) {
    throw InvalidInput(
        "metric: no sample of the fixed image counts: the mask is empty or lies outside the "
        "domain");
  }
  if (lowest == highest) {
    throw InvalidInput(message("metric: the fixed image is constant (", lowest,
                               ") where it counts; there is nothing to compare"));
  }
}

void check_overlap(const char* metric, double weight_inside, double weight) {
  if (4 * weight_inside >= weight) return;
  throw OverlapError(
      message(metric, ": only ", std::lround(100 * weight_inside / weight),
              " % of the samples fall inside the moving image; start from a transform "
              "that makes the images overlap, for example by aligning their centres "
              "(--init centres), or check spacing and origin of both images"));
}

template void check<2>(const MetricInput<2>&);
template void check<3>(const MetricInput<3>&);

}  // namespace crease
