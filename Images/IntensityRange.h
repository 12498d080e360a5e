#pragma once

#include <type_traits>

#include "Images/Image.h"

namespace crease {

/// Lowest and highest of some intensities.
struct IntensityRange {
  double lower = 0;
  double upper = 0;
  double width() const { return upper - lower; }
  bool constant() const { return !(upper > lower); }
};

/// The smallest and the largest pixel in the mask.
/// @param mask  null: all pixels; otherwise of the image's size.
/// @throws InvalidInput when the mask is empty or of another size.
template <int Dim>
IntensityRange intensity_range(const Image<float, Dim>& image,
                               const std::type_identity_t<Mask<Dim>>* mask = nullptr);

/// Two percentiles of the pixels in the mask, exact: of n sorted pixels the one of rank
/// round(p/100 (n - 1)). Two passes over the image, no sorting.
/// @param lower, upper  in percent, 0 <= lower <= upper <= 100.
/// @throws InvalidInput when the mask is empty or of another size, or for such percentages.
template <int Dim>
IntensityRange intensity_percentiles(const Image<float, Dim>& image,
                                     const std::type_identity_t<Mask<Dim>>* mask = nullptr,
                                     double lower = 1, double upper = 99);

/// The unit that metrics measure intensities in, so that weights mean the same for all images: from the
/// first to the 99th percentile in the mask, or from the smallest to the largest pixel where these
/// percentiles agree; 0 when all pixels do.
template <int Dim>
double intensity_unit(const Image<float, Dim>& image,
                      const std::type_identity_t<Mask<Dim>>* mask = nullptr) {
  const double width = intensity_percentiles(image, mask).width();
  return width > 0 ? width : intensity_range(image, mask).width();
}

extern template IntensityRange intensity_range<2>(const Image<float, 2>&, const Mask<2>*);
extern template IntensityRange intensity_range<3>(const Image<float, 3>&, const Mask<3>*);
extern template IntensityRange intensity_percentiles<2>(const Image<float, 2>&, const Mask<2>*,
                                                        double, double);
extern template IntensityRange intensity_percentiles<3>(const Image<float, 3>&, const Mask<3>*,
                                                        double, double);

}  // namespace crease
