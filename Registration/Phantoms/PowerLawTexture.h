#pragma once

#include <vector>

#include "Core/Point.h"
#include "Registration/Phantoms/Random.h"

namespace crease {

/// A random field like soft tissue in an X-ray: mean 0, deviation 1, amplitude spectrum
/// f^-exponent, smoothed by a Gaussian. Periodic; a cubic B-spline with knots at the multiples of 1
/// mm, so that an image sampled at these and interpolated by cubic B-splines gives the same
/// function again.
///
/// Made by one inverse Fourier transform of random coefficients; the B-spline's prefilter is a
/// division by its transform, the product over the axes of (2 + cos 2 pi f) / 3.
template <int Dim>
class PowerLawTexture {
 public:
  /// @param period_mm  rounded up to a power of two.
  /// @param blur_mm    deviation of the Gaussian.
  /// @param lowest_frequency  cycles per mm; there is nothing below.
  PowerLawTexture(double period_mm, double exponent, double blur_mm, Random random,
                  double lowest_frequency = 0);

  double operator()(const Point<Dim>& x) const;

 private:
  int size_;                          // a power of two
  std::vector<double> coefficients_;  // size_ per axis, first axis fastest
};

extern template class PowerLawTexture<2>;
extern template class PowerLawTexture<3>;

}  // namespace crease
