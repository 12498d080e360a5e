#pragma once

namespace crease {

/// One row of samples as arrays; entries begin - begin % 4 .. end rounded up to 4 are readable, with
/// weight 0 outside [begin, end).
struct SsdRow {
  int begin = 0;
  int end = 0;
  const float* fixed = nullptr;
  const float* weight = nullptr;
  const float* value = nullptr;
  const float* inside = nullptr;
  const float* gradient[3] = {};
  float volume = 1;          ///< mm^2 or mm^3 per sample
  float* force[3] = {};      ///< null: no forces wanted
  float* curvature[6] = {};  ///< null: no curvature wanted; entry i / 4 for sample i
};

/// Sums over the row.
struct SsdSums {
  double squares = 0;        ///< sum of w (value - fixed)^2
  double weight = 0;         ///< sum of w
  double weight_inside = 0;  ///< sum of w inside
};

/// Writes forces, adds curvatures and returns the sums.
using SsdRowKernel = SsdSums(const SsdRow& row, int dim);

namespace baseline {
SsdRowKernel ssd_row;
}
namespace avx2 {
SsdRowKernel ssd_row;
}

}  // namespace crease
