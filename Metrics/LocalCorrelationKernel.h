#pragma once

#include <cstdint>

namespace crease {

/// One row of samples for the correlation in windows: w weights, a and b the intensities. All arrays are
/// readable up to `count` rounded up to 4, with w = 0 beyond. What has four numbers per sample has them side
/// by side.
struct WindowedRow {
  int count = 0;
  const float* weight = nullptr;
  const float* a = nullptr;
  const float* b = nullptr;
  float shift = 0;  ///< to be taken off b
};

/// Sums over windows and what is derived from them, along one row.
struct CorrelatedRow {
  const float* of_fixed = nullptr;       ///< w, w a, w a a, unused
  const float* of_moving = nullptr;      ///< w b, w b b, w a b, unused
  const std::uint8_t* counts = nullptr;  ///< 0: the sample's window does not count
  double least_variance = 0;             ///< of b, for a window to be correlated
  float* by_moving = nullptr;            ///< w by_a, w by_b, w (what is left), 0
  float* by_weight = nullptr;  ///< null: not wanted; w by_aa, and of a and 1: see the source
  float* value = nullptr;      ///< likewise
};

/// Over a row's samples that count.
struct CorrelatedSums {
  double value = 0, weight = 0;  ///< w E, w
};

/// Window sums of a row's by_moving, each times `per_weight`, as slopes and curvature.
struct WindowedSlopes {
  const float* by_moving = nullptr;
  float per_weight = 1;
  float* slope = nullptr;
  float* curvature = nullptr;
};

/// w, w a, w a a, 0 and w b, w b b, w a b, 0 of each sample; null: not wanted.
using WindowProductsKernel = void(const WindowedRow& row, float* of_fixed, float* of_moving);
using CorrelateWindowsKernel = CorrelatedSums(const WindowedRow& row, const CorrelatedRow& sums);
using WindowedSlopesKernel = void(const WindowedRow& row, const WindowedSlopes& out);

namespace baseline {
WindowProductsKernel window_products;
CorrelateWindowsKernel correlate_windows;
WindowedSlopesKernel windowed_slopes;
}  // namespace baseline
namespace avx2 {
WindowProductsKernel window_products;
CorrelateWindowsKernel correlate_windows;
WindowedSlopesKernel windowed_slopes;
}  // namespace avx2

}  // namespace crease
