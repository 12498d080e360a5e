#include "Registration/PicturesSlices.h"

#include <algorithm>
#include <cmath>

#include "Registration/PicturesCanvas.h"

namespace crease {

template <int Dim>
std::vector<Slice<Dim>> slices(const Raster<Dim>& raster) {
  constexpr double kSmallest = 560, kLargest = 1200;
  double longest_mm = 0, longest_samples = 0;
  for (int a = 0; a < Dim; ++a) {
    longest_mm = std::max(longest_mm, raster.size[a] * raster.spacing[a]);
    longest_samples = std::max(longest_samples, double(raster.size[a]));
  }
  const double pixels_per_mm = std::clamp(longest_samples, kSmallest, kLargest) / longest_mm;
  std::vector<Slice<Dim>> result(Dim == 2 ? 1 : 3);
  for (std::size_t s = 0; s < result.size(); ++s) {
    Slice<Dim>& slice = result[s];
    if constexpr (Dim == 3) {
      slice.first = s == 2 ? 1 : 0;
      slice.second = s == 0 ? 1 : 2;
      slice.flipped = s > 0;
      slice.name = s == 0 ? "axial" : s == 1 ? "coronal" : "sagittal";
    }
    for (int a = 0; a < Dim; ++a) slice.middle[a] = raster.size[a] / 2;
    const auto length = [&](int axis) {
      return std::max(1, static_cast<int>(std::lround(raster.size[axis] * raster.spacing[axis] *
                                                      pixels_per_mm)));
    };
    slice.width = length(slice.first);
    slice.height = length(slice.second);
    slice.scale = {double(slice.width) / raster.size[slice.first],
                   double(slice.height) / raster.size[slice.second]};
  }
  return result;
}

template <typename Pixel, int Dim>
Image<Pixel, 2> samples(const Image<Pixel, Dim>& image, const Slice<Dim>& slice) {
  Raster<2> raster;
  raster.size = {image.size()[slice.first], image.size()[slice.second]};
  Image<Pixel, 2> plane(raster);
  auto index = slice.middle;
  for (int j = 0; j < raster.size[1]; ++j) {
    for (int i = 0; i < raster.size[0]; ++i) {
      index[slice.first] = i;
      index[slice.second] = slice.flipped ? raster.size[1] - 1 - j : j;
      plane(i, j) = image[index];
    }
  }
  return plane;
}

template <int Dim>
Image<float, 2> pixels(const Image<float, Dim>& image, const Slice<Dim>& slice) {
  return canvas::resized(samples(image, slice), slice.width, slice.height);
}

template std::vector<Slice<2>> slices<2>(const Raster<2>&);
template std::vector<Slice<3>> slices<3>(const Raster<3>&);
template Image<float, 2> samples(const Image<float, 2>&, const Slice<2>&);
template Image<float, 2> samples(const Image<float, 3>&, const Slice<3>&);
template Mask<2> samples(const Mask<2>&, const Slice<2>&);
template Mask<2> samples(const Mask<3>&, const Slice<3>&);
template Image<float, 2> pixels<2>(const Image<float, 2>&, const Slice<2>&);
template Image<float, 2> pixels<3>(const Image<float, 3>&, const Slice<3>&);

}  // namespace crease
