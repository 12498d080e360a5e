#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "Images/Image.h"

namespace crease::testing {

/// A raster whose axes are turned and whose pixels are not square.
template <int Dim>
Raster<Dim> turned_raster(const std::array<int, Dim>& size) {
  Raster<Dim> raster;
  raster.size = size;
  if constexpr (Dim == 2) {
    raster.origin = {-31.5, 12.25};
    raster.spacing = {0.75, 1.5};
    raster.direction = Eigen::Rotation2Dd(0.4).toRotationMatrix();
  } else {
    raster.origin = {-31.5, 12.25, 100.125};
    raster.spacing = {0.75, 1.5, 2.5};
    raster.direction =
        Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  }
  return raster;
}

template <int Dim>
Raster<Dim> plain_raster(const std::array<int, Dim>& size) {
  Raster<Dim> raster;
  raster.size = size;
  return raster;
}

/// Independent pixels in [0, 1): the hardest image for an interpolator.
template <int Dim>
Image<float, Dim> noise_image(const Raster<Dim>& raster, unsigned seed = 1) {
  std::mt19937 generator(seed);
  Image<float, Dim> image(raster);
  for (float& v : image.values()) v = static_cast<float>(generator() >> 8) * 0x1p-24f;
  return image;
}

/// Calls f(index as a vector) for every pixel.
template <int Dim, typename Function>
Image<float, Dim> image_of(const Raster<Dim>& raster, Function&& f) {
  Image<float, Dim> image(raster);
  for (std::int64_t p = 0; p < raster.num_samples(); ++p) {
    const auto index = image.index(p);
    Vector<Dim> at;
    for (int a = 0; a < Dim; ++a) at[a] = index[a];
    image[index] = static_cast<float>(f(at));
  }
  return image;
}

}  // namespace crease::testing
