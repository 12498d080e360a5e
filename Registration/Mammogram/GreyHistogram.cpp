#include "Registration/Mammogram/GreyHistogram.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "Images/IntensityRange.h"

namespace crease {
namespace {

constexpr int kBins = GreyHistogram::kBins;

/// Grey values counted on a fine even grid: counts[k] pixels have the grey value lower + k * step.
struct FineCounts {
  double lower = 0, step = 1;
  std::vector<double> counts;
};

/// Whole numbers on the coarsest grid that holds them all; others on 65536 levels.
FineCounts fine_counts(const Image<float, 2>& image) {
  constexpr double kLevels = 65535;
  const IntensityRange range = intensity_range(image);
  const bool whole = std::all_of(image.values().begin(), image.values().end(),
                                 [](float v) { return v == std::trunc(v); });
  FineCounts fine;
  fine.lower = range.lower;
  if (!whole || range.width() > kLevels) fine.step = range.constant() ? 1 : range.width() / kLevels;
  fine.counts.assign(static_cast<std::size_t>(std::lround(range.width() / fine.step)) + 1, 0.0);
  for (const float v : image.values()) {
    fine.counts[static_cast<std::size_t>(std::lround((v - fine.lower) / fine.step))] += 1;
  }
  if (!whole) return fine;
  std::size_t grid = 0;  // of 8-bit values stored in 12 or 16 bits, say
  for (std::size_t k = 1; k < fine.counts.size(); ++k) {
    if (fine.counts[k] > 0) grid = std::gcd(grid, k);
  }
  if (grid < 2) return fine;
  FineCounts coarse{fine.lower, fine.step * static_cast<double>(grid), {}};
  for (std::size_t k = 0; k < fine.counts.size(); k += grid)
    coarse.counts.push_back(fine.counts[k]);
  return coarse;
}

/// The grey value below which a share of the pixels lies.
double quantile(const FineCounts& fine, double share) {
  const double total = std::accumulate(fine.counts.begin(), fine.counts.end(), 0.0);
  double sum = 0;
  for (std::size_t k = 0; k < fine.counts.size(); ++k) {
    sum += fine.counts[k];
    if (sum > share * total) return fine.lower + static_cast<double>(k) * fine.step;
  }
  return fine.lower + static_cast<double>(fine.counts.size() - 1) * fine.step;
}

/// Spreads each level over the bins that [value - step/2, value + step/2] covers.
void fill_bins(const FineCounts& fine, GreyHistogram& histogram) {
  const double bins_per_grey = (kBins - 1) / (histogram.upper - histogram.lower);
  for (std::size_t k = 0; k < fine.counts.size(); ++k) {
    if (fine.counts[k] == 0) continue;
    const double value = fine.lower + static_cast<double>(k) * fine.step;
    const double middle = (value - histogram.lower) * bins_per_grey + 0.5;
    const double half = 0.5 * fine.step * bins_per_grey;
    const auto bin = [](double x) {
      return std::clamp(static_cast<int>(std::floor(x)), 0, kBins - 1);
    };
    const int first = bin(middle - half), last = bin(middle + half);
    for (int b = first; b <= last; ++b) {
      const double begin = b == first ? middle - half : b;
      const double end = b == last ? middle + half : b + 1;
      histogram.counts[b] += fine.counts[k] * (end - begin) / (2 * half);
    }
  }
}

int otsu_threshold(const std::array<double, kBins>& counts) {
  double total = 0, moment = 0;
  for (int t = 0; t < kBins; ++t) {
    total += counts[t];
    moment += t * counts[t];
  }
  int best = 0;
  double largest = -1, below = 0, moment_below = 0;
  for (int t = 0; t + 1 < kBins; ++t) {
    below += counts[t];
    moment_below += t * counts[t];
    if (below == 0 || below == total) continue;
    const double distance = moment_below / below - (moment - moment_below) / (total - below);
    const double between = below * (total - below) * distance * distance;
    if (between > largest) {
      largest = between;
      best = t;
    }
  }
  return best;
}

/// ln(1 + counts) blurred by a Gaussian of 1 bin. The outer bins, where clipped values pile up, are replaced by
/// their neighbours, which stand for what lies beyond, too.
std::array<double, kBins> smoothed_logarithms(const std::array<double, kBins>& counts) {
  constexpr int kReach = 4;
  std::array<double, kBins> result{};
  double sum = 0;
  for (int d = -kReach; d <= kReach; ++d) sum += std::exp(-0.5 * d * d);
  for (int t = 0; t < kBins; ++t) {
    for (int d = -kReach; d <= kReach; ++d) {
      result[t] +=
          std::exp(-0.5 * d * d) / sum * std::log1p(counts[std::clamp(t + d, 1, kBins - 2)]);
    }
  }
  return result;
}

std::optional<int> first_valley(const std::array<double, kBins>& l, int background, int otsu) {
  constexpr int kWindow = 5;
  for (int t = background + 1; t <= otsu; ++t) {
    bool lowest = l[t] <= l[t - 1];
    for (int d = 1; d <= kWindow && t + d < kBins; ++d) lowest = lowest && l[t] <= l[t + d];
    if (lowest) return t;
  }
  return std::nullopt;
}

}  // namespace

GreyHistogram grey_histogram(const Image<float, 2>& image) {
  constexpr double kTail = 1e-4;
  GreyHistogram histogram;
  if (image.empty()) return histogram;
  const FineCounts fine = fine_counts(image);
  histogram.lower = quantile(fine, kTail);
  histogram.upper = quantile(fine, 1 - kTail);
  if (!(histogram.upper > histogram.lower)) {  // nearly all pixels are equal
    histogram.lower = fine.lower;
    histogram.upper = fine.lower + static_cast<double>(fine.counts.size() - 1) * fine.step;
  }
  if (!(histogram.upper > histogram.lower)) return histogram;
  fill_bins(fine, histogram);
  histogram.smoothed = smoothed_logarithms(histogram.counts);
  histogram.otsu = otsu_threshold(histogram.counts);
  const auto begin = histogram.smoothed.begin();
  histogram.background =
      static_cast<int>(std::max_element(begin, begin + histogram.otsu + 1) - begin);
  histogram.valley = first_valley(histogram.smoothed, histogram.background, histogram.otsu);
  return histogram;
}

}  // namespace crease
