#pragma once

#include <cstdint>

namespace crease {

/// Positions of intensities among bins: clamp((I - lower) per_intensity + 2, 2, last), as IntensityBins.
struct BinScale {
  float lower = 0;
  float per_intensity = 1;
  float last = 2;
};

/// Samples of one row for a joint histogram of `bins` x `bins` cells, row by row of the fixed image's bins.
struct HistogramRow {
  int count = 0;
  int bins = 0;
  const float* weight = nullptr;
  const float* moving = nullptr;
  BinScale moving_scale;
  const std::uint8_t* fixed_bin = nullptr;  ///< box window: the bin; null: a cubic window
  const float* fixed = nullptr;             ///< cubic window
  BinScale fixed_scale;
};

/// How many histograms samples are added to in turn: two of the same cell in a row need not wait for each
/// other.
constexpr int kHistogramCopies = 4;
/// Counts are whole numbers, so that their sums are exact in any order: a weight of `per_count` counts 1.
/// With weights up to 1 and this scale, kHistogramCopies copies hold kHistogramCapacity samples.
constexpr float kCountsPerWeight = 1 << 19;
constexpr int kHistogramCapacity = 1 << 14;

/// Derivatives of one row, to be written.
struct InformationSlopes {
  /// Four numbers for each cell (k, l) of the joint histogram: for a sample whose position lies in
  /// [l, l + 1), with t the position less l, the slope of the value by the position is the first + the
  /// second t + the third t^2; the fourth is its curvature.
  const float* cells = nullptr;
  const float* start = nullptr;  ///< the value at t = 0, per cell; null: no by_weight wanted
  float mean = 0;                ///< to be taken off by_weight
  float* by_moving = nullptr;
  float* curvature = nullptr;
  float* by_weight = nullptr;
};

/// Adds weight * counts * shares to kHistogramCopies histograms, one behind the other.
using AddToHistogramKernel = void(const HistogramRow& row, float counts, std::int32_t* histograms);
using InformationSlopesKernel = void(const HistogramRow& row, const InformationSlopes& out);

namespace baseline {
AddToHistogramKernel add_to_histogram;
InformationSlopesKernel information_slopes;
}  // namespace baseline
namespace avx2 {
AddToHistogramKernel add_to_histogram;
InformationSlopesKernel information_slopes;
}  // namespace avx2

}  // namespace crease
