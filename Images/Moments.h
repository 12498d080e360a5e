#pragma once

#include <type_traits>

#include "Images/Image.h"

namespace crease {

/// Where the intensities of an image lie. The lowest intensity in the mask counts as zero mass, so that
/// negative intensities (CT) and a grey background pull nothing.
template <int Dim>
struct Moments {
  double mass = 0;                         ///< sum of intensities above the lowest, times mm^Dim
  Point<Dim> centre = Point<Dim>::Zero();  ///< mm
  Matrix<Dim> covariance = Matrix<Dim>::Zero();  ///< mm^2
};

/// @param mask  null: all pixels; otherwise of the image's size.
/// A constant image has no mass: its moments are those of the mask itself, with mass 0.
/// @throws InvalidInput when the mask is empty or of another size.
template <int Dim>
Moments<Dim> moments(const Image<float, Dim>& image,
                     const std::type_identity_t<Mask<Dim>>* mask = nullptr);

/// The middle of all pixels, mm.
template <int Dim>
Point<Dim> geometric_centre(const Raster<Dim>& raster) {
  Vector<Dim> index;
  for (int a = 0; a < Dim; ++a) index[a] = 0.5 * (raster.size[a] - 1);
  return raster.point(index);
}

extern template Moments<2> moments<2>(const Image<float, 2>&, const Mask<2>*);
extern template Moments<3> moments<3>(const Image<float, 3>&, const Mask<3>*);

}  // namespace crease
