#pragma once

#include "Images/Interpolator.h"

namespace crease {

/// An image seen through a displacement:
///
///     I'(y) = I(y + d(y)),     grad I'(y) = (1 + grad d(y))^T grad I(y + d(y)).
///
/// The maps are composed, so that the image is interpolated once and never resampled. A second map is found on
/// top of a first one by comparing with I' as with any other image.
///
/// The gradient is that of the interpolated d, so that value and gradient agree. What is inside is said by
/// I alone; beyond the raster of d, d stays as it is at its border. A row costs one interpolation of each component more.
template <int Dim>
class DisplacedInterpolator final : public Interpolator<Dim> {
 public:
  using typename Interpolator<Dim>::Sample;
  /// d_a in mm, on any raster that covers the points y.
  using Components = std::array<std::shared_ptr<const Interpolator<Dim>>, Dim>;

  /// @throws InvalidInput when a part is null.
  DisplacedInterpolator(std::shared_ptr<const Interpolator<Dim>> image, Components displacement);

  /// That of I.
  const Raster<Dim>& raster() const override { return image_->raster(); }
  Sample evaluate(const Point<Dim>& y) const override;
  void evaluate_row(const MappedRow<Dim>& row, float* value,
                    const std::array<float*, Dim>& gradient, float* inside) const override;
  IntensityRange coefficient_range() const override { return image_->coefficient_range(); }
  IntensityRange coefficient_range(const Mask<Dim>& mask) const override {
    return image_->coefficient_range(mask);
  }

 private:
  std::shared_ptr<const Interpolator<Dim>> image_;
  Components displacement_;
};

extern template class DisplacedInterpolator<2>;
extern template class DisplacedInterpolator<3>;

}  // namespace crease
