#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "Core/Point.h"
#include "Core/Raster.h"
#include "Images/IntensityRange.h"

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
///
/// A point is inside when its continuous index lies in [-0.5, size - 0.5] along every axis: within the
/// outer pixels' borders. Everywhere the value is the interpolant's at the index clamped to
/// [0, size - 1], the centres of the outer pixels. Inside, the gradient is the exact gradient of that:
/// no component along an axis whose index was clamped. Outside it is zero.
/// A point that is not finite has the value NaN and is not inside.
template <int Dim>
class Interpolator {
 public:
  /// The image at a point; `inside`: the point lies in the box of all pixels.
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

  /// Bounds that no value leaves, anywhere: the range of the coefficients.
  virtual IntensityRange coefficient_range() const = 0;
  /// Bounds that no value leaves at points within the pixels of the mask.
  /// @param mask  of the image's size. @throws InvalidInput when it is not, or is empty.
  virtual IntensityRange coefficient_range(const Mask<Dim>& mask) const = 0;
};

}  // namespace crease
