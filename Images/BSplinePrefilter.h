#pragma once

#include "Images/PaddedPixels.h"

namespace crease {

/// Coefficients c of the cubic B-spline sum_k c_k beta3(x - k) that passes through all pixels, mirrored
/// at the centres of the outer pixels: along every axis the recursive filter with the pole sqrt(3) - 2.
/// An axis of a single pixel is left as it is. Single precision; about 4 ns per pixel.
///
/// @throws InvalidInput as check_interpolable.
/// Source: M. Unser, "Splines: a perfect fit for signal and image processing", IEEE Signal Processing
/// Magazine 16(6), 1999.
template <int Dim>
PaddedPixels<Dim> cubic_bspline_coefficients(const Image<float, Dim>& image);

extern template PaddedPixels<2> cubic_bspline_coefficients<2>(const Image<float, 2>&);
extern template PaddedPixels<3> cubic_bspline_coefficients<3>(const Image<float, 3>&);

}  // namespace crease
