#pragma once

#include <cmath>

#include "Images/InterpolationKernel.h"
#include "Images/Interpolator.h"
#include "Images/PaddedPixels.h"

// What the interpolators share: where a point lies among the pixels, and a row in the kernels' terms.
namespace crease::detail {

/// A point among the pixels, as Interpolator defines it.
template <int Dim>
struct PixelPosition {
  /// @param last  the whole index is at most size - last.
  PixelPosition(const Raster<Dim>& raster, const Point<Dim>& x, int last) {
    const Vector<Dim> index = raster.index(x);
    finite = index.allFinite();
    inside = finite;
    if (!finite) return;
    for (int a = 0; a < Dim; ++a) {
      const double top = raster.size[a] - 1;
      inside = inside && index[a] >= -0.5 && index[a] <= top + 0.5;
      free[a] = index[a] > 0 && index[a] < top;
      const double t = std::clamp(index[a], 0.0, top);
      whole[a] = std::min(static_cast<int>(t), std::max(0, raster.size[a] - last));
      fraction[a] = t - whole[a];
    }
  }
  bool finite = false;
  bool inside = false;
  std::array<bool, Dim> free{};  ///< the index was not clamped
  std::array<int, Dim> whole{};
  std::array<double, Dim> fraction{};
};

/// The sum over `Taps` pixels per axis with separable weights, and its gradient per index step.
/// @param corner  the pixel with the first weights.
template <int Dim, int Taps>
void sum_taps(const float* corner, const std::array<int, Dim>& stride,
              const std::array<std::array<double, Taps>, Dim>& weight,
              const std::array<std::array<double, Taps>, Dim>& derivative, double& value,
              Vector<Dim>& gradient) {
  value = 0;
  gradient.setZero();
  for (int k = 0; k < (Dim == 3 ? Taps : 1); ++k) {
    for (int j = 0; j < Taps; ++j) {
      const float* row = corner + std::int64_t{j} * stride[1];
      if constexpr (Dim == 3) row += std::int64_t{k} * stride[2];
      double v = 0, d = 0;
      for (int i = 0; i < Taps; ++i) {
        v += weight[0][i] * row[i];
        d += derivative[0][i] * row[i];
      }
      const double wz = Dim == 3 ? weight[Dim - 1][k] : 1;
      value += v * weight[1][j] * wz;
      gradient[0] += d * weight[1][j] * wz;
      gradient[1] += v * derivative[1][j] * wz;
      if constexpr (Dim == 3) gradient[2] += v * weight[1][j] * derivative[2][k];
    }
  }
}

template <int Dim>
InterpolationRow kernel_row(const Raster<Dim>& raster, const PaddedPixels<Dim>& pixels,
                            const MappedRow<Dim>& row, float* value,
                            const std::array<float*, Dim>& gradient, float* inside) {
  InterpolationRow out;
  const Matrix<Dim> to_index = raster.point_to_index();
  const Vector<Dim> start = to_index * (row.start - raster.origin), step = to_index * row.step;
  out.pixels = pixels.data();
  out.begin = row.begin;
  out.end = row.end;
  out.value = value;
  out.inside = inside;
  for (int a = 0; a < Dim; ++a) {
    out.size[a] = raster.size[a];
    out.stride[a] = pixels.stride()[a];
    out.start[a] = start[a];
    out.step[a] = step[a];
    out.displacement[a] = row.displacement[a];
    out.gradient[a] = gradient[a];
    for (int b = 0; b < Dim; ++b) out.to_index[a][b] = static_cast<float>(to_index(a, b));
  }
  return out;
}

}  // namespace crease::detail
