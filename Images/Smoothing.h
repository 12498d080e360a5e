#pragma once

#include "Images/Image.h"

namespace crease {

/// The light low-pass [1 2 1]/4 along every axis, outer pixels repeated beyond the border. On both images
/// at full resolution it lowers the error of a registration of noisy images.
template <int Dim>
Image<float, Dim> smooth_121(const Image<float, Dim>& image);

/// Convolution with a Gaussian of standard deviation sigma_mm, cut off at four sigma, outer pixels
/// repeated beyond the border. Axes along which sigma is below 0.1 pixel are left as they are.
/// @throws InvalidInput unless sigma_mm is finite and not negative.
template <int Dim>
Image<float, Dim> gaussian_smooth(const Image<float, Dim>& image, double sigma_mm);

extern template Image<float, 2> smooth_121<2>(const Image<float, 2>&);
extern template Image<float, 3> smooth_121<3>(const Image<float, 3>&);
extern template Image<float, 2> gaussian_smooth<2>(const Image<float, 2>&, double);
extern template Image<float, 3> gaussian_smooth<3>(const Image<float, 3>&, double);

}  // namespace crease
