#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

// Quantiles of samples. A share of 0 asks for the smallest value, 1 for the largest, 0.5 for the median.
namespace crease {

/// Where the quantile stands among `count` > 0 sorted values, from 0: the nearest rank, the upper one of two.
inline std::int64_t nearest_rank(std::int64_t count, double share) {
  assert(count > 0 && share >= 0 && share <= 1);
  return std::lround(share * static_cast<double>(count - 1));
}

/// The value that would stand at this rank if the values were sorted. They are reordered. O(n).
template <typename T>
T value_of_rank(std::span<T> values, std::int64_t rank) {
  const auto place = values.begin() + rank;
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// The value of the nearest rank; of two middle values the larger is the median. Values that are not needed
/// afterwards may be moved in.
template <typename T>
T quantile(std::vector<T> values, double share) {
  return value_of_rank(std::span<T>(values), nearest_rank(std::ssize(values), share));
}
template <typename T>
T median(std::vector<T> values) {
  return quantile(std::move(values), 0.5);
}

/// Between two ranks, by linear interpolation. The values must be sorted.
inline double interpolated_quantile(std::span<const double> sorted, double share) {
  assert(!sorted.empty() && share >= 0 && share <= 1);
  const double rank = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (rank - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

}  // namespace crease
