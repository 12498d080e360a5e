#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "Core/Point.h"
#include "Core/Raster.h"

namespace crease {

/// Points of the moving image that a row of fixed samples is mapped to:
/// sample i goes to start + i * step + u(i), for begin <= i < end, in mm.
/// Affine part in double, displacement in single precision: this keeps wide images exact.
template <int Dim>
struct MappedRow {
  std::int64_t row = 0;  ///< row of the fixed raster
  int begin = 0;
  int end = 0;
  Point<Dim> start = Point<Dim>::Zero();
  Vector<Dim> step = Vector<Dim>::Zero();
  std::array<const float*, Dim> displacement{};  ///< entry i for sample i; null = zero
};

/// Values of an image between its pixels, with the exact gradient of the interpolant.
/// Outside the image (beyond the outer pixels' borders) the value is that of the nearest point of the
/// border and the gradient is zero.
template <int Dim>
class Interpolator {
 public:
  struct Sample {
    double value = 0;
    Vector<Dim> gradient = Vector<Dim>::Zero();  ///< per mm
    bool inside = false;
  };

  virtual ~Interpolator() = default;
  virtual const Raster<Dim>& raster() const = 0;
  /// Double precision, one point, in mm.
  virtual Sample evaluate(const Point<Dim>& x) const = 0;
  /// Single precision, a row at a time, vectorised. Writes entries begin .. end-1 (and may write up to
  /// 16 entries beyond on either side within the row buffers): value[i], gradient[a][i] per mm (null
  /// pointers: not wanted), and inside[i] = 1 or 0.
  virtual void evaluate_row(const MappedRow<Dim>& row, float* value,
                            const std::array<float*, Dim>& gradient, float* inside) const = 0;
};

}  // namespace crease
