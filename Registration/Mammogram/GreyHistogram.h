#pragma once

#include <array>
#include <optional>

#include "Images/Image.h"

namespace crease {

/// Grey values counted in 256 bins, and where the breast's begin.
struct GreyHistogram {
  static constexpr int kBins = 256;
  double lower = 0, upper = 0;  ///< grey values of the middles of the first and the last bin
  std::array<double, kBins> counts{};
  std::array<double, kBins> smoothed{};  ///< ln(1 + counts), blurred by a Gaussian of 1 bin
  int otsu = 0;                          ///< Otsu's threshold: the darker class ends with this bin
  int background = 0;                    ///< the highest of the bins up to `otsu`
  std::optional<int> valley;             ///< beyond the background's bins; none: there is no valley

  /// The grey value between bin t and the next.
  double grey_value(double t) const { return lower + (t + 0.5) * (upper - lower) / (kBins - 1); }
  /// The last bin that is not the breast's: the valley, else Otsu's threshold.
  int threshold() const { return valley.value_or(otsu); }
};

/// Counts grey values between the 0.01 % and 99.99 % percentiles; what lies beyond counts in the outer bins.
/// Values on a coarser grid than the bins are spread evenly over them, so that no bin between is empty.
///
/// The valley is the smallest t above the background's peak b and up to Otsu's threshold with
/// l(t) <= l(t - 1) and l(t) <= l(t + 1 .. t + 5), l the smoothed logarithms: the first valley seen from the
/// background's side. (Seen from the highest peak, which is the background's own flank in most films, it would
/// lie below all grey values, and seen from the breast's own mode it takes the skin away.)
/// Source: dissertation, chapter 5.1; N. Otsu, "A threshold selection method from gray-level histograms", 1979.
GreyHistogram grey_histogram(const Image<float, 2>& image);

}  // namespace crease
