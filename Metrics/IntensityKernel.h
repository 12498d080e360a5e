#pragma once

namespace crease {

/// Derivatives of one row by the moving intensities, to be carried to the mapped points by the gradients of
/// the moving image and its mask. All arrays are readable from begin - begin % 4 to end rounded up to 4;
/// slopes and curvatures are 0 outside [begin, end).
struct SlopeRow {
  int begin = 0;
  int end = 0;
  const float* slope = nullptr;       ///< dE / dI_m
  const float* curvature = nullptr;   ///< d2E / dI_m2, >= 0
  const float* gradient[3] = {};      ///< of I_m
  const float* mask_slope = nullptr;  ///< dE / dm; null: no mask
  const float* mask_gradient[3] = {};
  float* force[3] = {};
  float* curvature_sum[6] = {};  ///< null: not wanted; entry i / 4 for sample i, added to
};

/// Weighted sums of one row: w, w a, w b, w a a, w b b, w a b.
struct ProductSums {
  double values[6] = {};
};

/// Sums of weights of one row.
struct WeightSums {
  double weight = 0, weight_inside = 0;  ///< w, w inside
};

/// dE/db = w (by_a (a - mean_a) + by_b (b - mean_b)) and the curvature w c of some samples.
struct CorrelationRow {
  int count = 0;
  const float* weight = nullptr;
  const float* a = nullptr;
  const float* b = nullptr;
  float by_a = 0, by_b = 0, mean_a = 0, mean_b = 0, c = 0;
  float* slope = nullptr;
  float* curvature = nullptr;
};

using SlopeRowKernel = void(const SlopeRow& row, int dim);
using ProductSumsKernel = ProductSums(const float* weight, const float* a, const float* b,
                                      int count);
using WeightSumsKernel = WeightSums(const float* weight, const float* inside, int count);
/// to += factor * from.
using AddScaledKernel = void(const float* from, float factor, float* to, int count);
using CorrelationSlopesKernel = void(const CorrelationRow& row);

namespace baseline {
SlopeRowKernel carry_slopes;
ProductSumsKernel product_sums;
WeightSumsKernel weight_sums;
CorrelationSlopesKernel correlation_slopes;
AddScaledKernel add_scaled;
}  // namespace baseline
namespace avx2 {
SlopeRowKernel carry_slopes;
ProductSumsKernel product_sums;
WeightSumsKernel weight_sums;
CorrelationSlopesKernel correlation_slopes;
AddScaledKernel add_scaled;
}  // namespace avx2

}  // namespace crease
