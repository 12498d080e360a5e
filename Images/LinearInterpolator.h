#pragma once

#include "Images/Interpolator.h"
#include "Images/PaddedPixels.h"

namespace crease {

/// Bilinear (2D) or trilinear (3D) interpolation. Its gradient is that of the patch between
/// neighbouring pixels: it jumps at pixel centres, where it is that of the patch on the side of greater
/// index.
template <int Dim>
class LinearInterpolator final : public Interpolator<Dim> {
 public:
  using typename Interpolator<Dim>::Sample;

  /// Copies the image. @throws InvalidInput when pixels are not finite.
  explicit LinearInterpolator(const Image<float, Dim>& image);

  const Raster<Dim>& raster() const override { return raster_; }
  Sample evaluate(const Point<Dim>& x) const override;
  void evaluate_row(const MappedRow<Dim>& row, float* value,
                    const std::array<float*, Dim>& gradient, float* inside) const override;
  IntensityRange coefficient_range() const override;
  IntensityRange coefficient_range(const Mask<Dim>& mask) const override;

 private:
  Raster<Dim> raster_;
  PaddedPixels<Dim> pixels_;
};

extern template class LinearInterpolator<2>;
extern template class LinearInterpolator<3>;

}  // namespace crease
