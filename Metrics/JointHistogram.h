#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "Metrics/ParzenWindow.h"

namespace crease {

/// -sum p ln p.
double entropy(const std::vector<double>& probabilities);

/// How a joint histogram is turned into a number.
enum class InformationKind {
  kMutual,     ///< sum p ln (p / (p_f p_m))
  kNormalized  ///< (H_f + H_m) / H_fm (Studholme, Hill and Hawkes, Pattern Recognition 32, 1999)
};

/// Joint probabilities p(k, l) of the bins of two images, k of the fixed one, and the information in them.
/// Source: registration theory 4.1; D. Mattes et al., IEEE Transactions on Medical Imaging 22, 2003.
class JointHistogram {
 public:
  explicit JointHistogram(int bins);

  int bins() const { return bins_; }
  /// Row of the moving bins of a fixed bin.
  double* row(int k) { return &values_[static_cast<std::size_t>(k) * bins_]; }
  const double* row(int k) const { return &values_[static_cast<std::size_t>(k) * bins_]; }
  JointHistogram& operator+=(const JointHistogram& other);
  /// Adds a sum of weights to each cell, in the order of rows.
  JointHistogram& operator+=(std::span<const std::int32_t> counts);

  /// Makes probabilities of sums of weights. @return their sum.
  double normalise();
  std::vector<double> fixed_marginal() const;
  std::vector<double> moving_marginal() const;

  /// What is derived from probabilities.
  struct Information {
    double value = 0;
    /// d value / d p(k, l), up to a constant that does not matter; 0 where p = 0.
    std::vector<double> slope;
    double mean_slope = 0;  ///< sum p slope
    /// Per fixed bin: the mean of (d ln p(l | k) / dl)^2, which tells how fast the value falls when
    /// intensities of that bin are moved, per bin^2.
    std::vector<double> curvature;
  };
  Information information(InformationKind kind) const;

 private:
  int bins_;
  std::vector<double> values_;
};

}  // namespace crease
