#pragma once

#include <cmath>
#include <functional>

#include "Images/Image.h"
#include "Transforms/AffineMap.h"

namespace crease::testing {

/// A smooth scene with structure everywhere, so that every motion of a pixel shows.
template <int Dim>
double scene(const Point<Dim>& x) {
  double value = 1 + 0.4 * std::sin(0.19 * x[0] + 0.5) * std::cos(0.13 * x[1]) +
                 0.3 * std::sin(0.11 * x[1] + 0.07 * x[0]) +
                 0.2 * std::cos(0.31 * x[0] - 0.23 * x[1]);
  if constexpr (Dim == 3) {
    value += 0.3 * std::sin(0.29 * x[2] - 0.17 * x[0]) + 0.2 * std::cos(0.27 * x[1] + 0.21 * x[2]);
  }
  return value;
}

template <int Dim>
Raster<Dim> raster_of(int size) {
  Raster<Dim> raster;
  raster.size.fill(size);
  return raster;
}

/// scene(map(x)) at every sample.
template <int Dim>
Image<float, Dim> image_of(const Raster<Dim>& raster,
                           const std::function<Point<Dim>(const Point<Dim>&)>& map) {
  Image<float, Dim> image(raster);
  for (std::int64_t k = 0; k < raster.num_samples(); ++k) {
    const auto index = image.index(k);
    Vector<Dim> i;
    for (int a = 0; a < Dim; ++a) i[a] = index[a];
    image[index] = static_cast<float>(scene<Dim>(map(raster.point(i))));
  }
  return image;
}

template <int Dim>
Image<float, Dim> scene_image(const Raster<Dim>& raster) {
  return image_of<Dim>(raster, [](const Point<Dim>& x) { return x; });
}

/// The linear map about the raster's centre, then a shift.
template <int Dim>
AffineMap<Dim> about_centre(const Raster<Dim>& raster, const Matrix<Dim>& linear,
                            const Vector<Dim>& shift) {
  const Point<Dim> centre = 0.5 * (raster.bounds().lower + raster.bounds().upper);
  AffineMap<Dim> map;
  map.linear = linear;
  map.offset = centre + shift - linear * centre;
  return map;
}

/// Root mean square of |a(x) - b(x)| over samples at least `margin` pixels from the border, mm.
template <int Dim, typename A, typename B>
double rms_difference(const Raster<Dim>& raster, const A& a, const B& b, int margin) {
  double sum = 0, count = 0;
  const Image<char, Dim> numbering(raster);
  for (std::int64_t k = 0; k < raster.num_samples(); k += 3) {
    const auto index = numbering.index(k);
    bool inner = true;
    Vector<Dim> i;
    for (int c = 0; c < Dim; ++c) {
      i[c] = index[c];
      inner = inner && index[c] >= margin && index[c] < raster.size[c] - margin;
    }
    if (!inner) continue;
    const Point<Dim> x = raster.point(i);
    sum += (a(x) - b(x)).squaredNorm();
    count += 1;
  }
  return std::sqrt(sum / count);
}

}  // namespace crease::testing
