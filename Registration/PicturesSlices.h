#pragma once

#include <string>
#include <vector>

#include "Images/Image.h"

namespace crease {

/// A plane of samples of an image and its place in a picture.
template <int Dim>
struct Slice {
  std::string name;               ///< "" in 2D
  int first = 0, second = 1;      ///< the image's axes to the right and (unless flipped) downwards
  bool flipped = false;           ///< the second axis runs upwards
  std::array<int, Dim> middle{};  ///< an index in the plane
  int width = 0, height = 0;      ///< pixels in the picture
  Vector<2> scale = Vector<2>::Ones();  ///< pixels per step of index

  /// The pixel (centres at whole numbers) of an index.
  Point<2> pixel(const Vector<Dim>& index) const {
    const double x = (index[first] + 0.5) * scale.x() - 0.5;
    const double y = (index[second] + 0.5) * scale.y() - 0.5;
    return {x, flipped ? height - 1 - y : y};
  }
};

/// The whole image (2D), or the middle slices across the last, second and first axis (3D), sized so
/// that the longest side has 560 to 1200 pixels.
template <int Dim>
std::vector<Slice<Dim>> slices(const Raster<Dim>& raster);

/// The samples of the slice on a grid of their own.
template <typename Pixel, int Dim>
Image<Pixel, 2> samples(const Image<Pixel, Dim>& image, const Slice<Dim>& slice);

/// The same, resampled to the slice's pixels.
template <int Dim>
Image<float, 2> pixels(const Image<float, Dim>& image, const Slice<Dim>& slice);

extern template std::vector<Slice<2>> slices<2>(const Raster<2>&);
extern template std::vector<Slice<3>> slices<3>(const Raster<3>&);
extern template Image<float, 2> samples(const Image<float, 2>&, const Slice<2>&);
extern template Image<float, 2> samples(const Image<float, 3>&, const Slice<3>&);
extern template Mask<2> samples(const Mask<2>&, const Slice<2>&);
extern template Mask<2> samples(const Mask<3>&, const Slice<3>&);
extern template Image<float, 2> pixels<2>(const Image<float, 2>&, const Slice<2>&);
extern template Image<float, 2> pixels<3>(const Image<float, 3>&, const Slice<3>&);

}  // namespace crease
