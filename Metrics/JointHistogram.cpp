#include "Metrics/JointHistogram.h"

#include <cmath>
#include <numeric>

namespace crease {

namespace {

/// ln p; 0 where p = 0.
std::vector<double> logarithms(const std::vector<double>& probabilities) {
  std::vector<double> result(probabilities.size(), 0.0);
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (probabilities[i] > 0) result[i] = std::log(probabilities[i]);
  }
  return result;
}

/// -sum p ln p.
double entropy(const std::vector<double>& p, const std::vector<double>& log_p) {
  return -std::inner_product(p.begin(), p.end(), log_p.begin(), 0.0);
}

/// Mean square of the slope of ln p along a row, where both neighbours are known.
double fisher_information(const double* row, const double* log_row, int bins) {
  double sum = 0, weight = 0;
  for (int l = 1; l + 1 < bins; ++l) {
    if (!(row[l - 1] > 0) || !(row[l + 1] > 0)) continue;
    const double slope = 0.5 * (log_row[l + 1] - log_row[l - 1]);
    sum += row[l] * slope * slope;
    weight += row[l];
  }
  return weight > 0 ? sum / weight : 0;
}

}  // namespace

double entropy(const std::vector<double>& probabilities) {
  return entropy(probabilities, logarithms(probabilities));
}

JointHistogram::JointHistogram(int bins)
    : bins_(bins), values_(static_cast<std::size_t>(bins) * bins, 0.0) {}

JointHistogram& JointHistogram::operator+=(const JointHistogram& other) {
  for (std::size_t i = 0; i < values_.size(); ++i) values_[i] += other.values_[i];
  return *this;
}

JointHistogram& JointHistogram::operator+=(std::span<const std::int32_t> counts) {
  for (std::size_t i = 0; i < values_.size(); ++i) values_[i] += counts[i];
  return *this;
}

double JointHistogram::normalise() {
  const double sum = std::accumulate(values_.begin(), values_.end(), 0.0);
  if (sum > 0) {
    for (double& v : values_) v /= sum;
  }
  return sum;
}

std::vector<double> JointHistogram::fixed_marginal() const {
  std::vector<double> sums(static_cast<std::size_t>(bins_), 0.0);
  for (int k = 0; k < bins_; ++k) {
    sums[k] = std::accumulate(row(k), row(k) + bins_, 0.0);
  }
  return sums;
}

std::vector<double> JointHistogram::moving_marginal() const {
  std::vector<double> sums(static_cast<std::size_t>(bins_), 0.0);
  for (int k = 0; k < bins_; ++k) {
    for (int l = 0; l < bins_; ++l) sums[l] += row(k)[l];
  }
  return sums;
}

JointHistogram::Information JointHistogram::information(InformationKind kind) const {
  const auto of_fixed = fixed_marginal(), of_moving = moving_marginal();
  const auto log_fixed = logarithms(of_fixed), log_moving = logarithms(of_moving);
  const auto log_joint = logarithms(values_);
  Information result;
  const double joint = entropy(values_, log_joint);
  const double marginals = entropy(of_fixed, log_fixed) + entropy(of_moving, log_moving);
  const bool mutual = kind == InformationKind::kMutual;
  const double ratio = joint > 0 ? marginals / joint : 2;
  result.value = mutual ? marginals - joint : ratio;
  // d(H_f + H_m) = -sum dp (ln p_f + ln p_m), dH_fm = -sum dp ln p, up to constants times sum dp.
  const double by_marginals = mutual || !(joint > 0) ? 1 : 1 / joint;
  const double by_joint = mutual || !(joint > 0) ? 1 : ratio / joint;
  result.slope.assign(values_.size(), 0.0);
  result.curvature.assign(static_cast<std::size_t>(bins_), 0.0);
  for (int k = 0; k < bins_; ++k) {
    const double* log_row = &log_joint[static_cast<std::size_t>(k) * bins_];
    for (int l = 0; l < bins_; ++l) {
      const double p = row(k)[l];
      if (!(p > 0)) continue;
      const double slope = by_joint * log_row[l] - by_marginals * (log_fixed[k] + log_moving[l]);
      result.slope[static_cast<std::size_t>(k) * bins_ + l] = slope;
      result.mean_slope += p * slope;
    }
    result.curvature[k] = by_joint * fisher_information(row(k), log_row, bins_);
  }
  return result;
}

}  // namespace crease
