#pragma once

namespace crease {

/// What the interpolation kernels need for one row of samples, as plain numbers.
/// Sample i lies at the continuous index start + i * step + to_index * displacement[.][i].
struct InterpolationRow {
  const float* pixels = nullptr;  ///< pixel (0, 0[, 0]), with four mirrored ones on every side
  int size[3] = {};
  int stride[3] = {};  ///< floats from a pixel to its neighbour along each axis
  int begin = 0;       ///< samples begin .. end-1 are read and written, no others
  int end = 0;
  double start[3] = {};
  double step[3] = {};
  const float* displacement[3] = {};  ///< mm; null: zero
  float to_index[3][3] = {};          ///< index per mm: row = axis of the index
  float* value = nullptr;
  float* gradient[3] = {};  ///< per mm; null: not wanted
  float* inside = nullptr;  ///< 1 or 0
};

using InterpolationKernel = void(const InterpolationRow& row);

namespace baseline {
InterpolationKernel cubic_row_2, cubic_row_3, linear_row_2, linear_row_3;
}
namespace avx2 {
InterpolationKernel cubic_row_2, cubic_row_3, linear_row_2, linear_row_3;
}

}  // namespace crease
