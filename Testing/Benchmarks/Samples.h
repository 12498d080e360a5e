#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "Images/Image.h"
#include "Transforms/Domains/KnotNet.h"
#include "Transforms/Splines/TensorBSplineBasis.h"

namespace crease::benchmarks {

/// Pixels of 1 mm.
template <int Dim>
Raster<Dim> raster_of(const std::array<int, Dim>& size) {
  Raster<Dim> raster;
  raster.size = size;
  return raster;
}

/// Values that change from pixel to pixel.
template <int Dim>
Image<float, Dim> wavy_image(const std::array<int, Dim>& size) {
  Image<float, Dim> image(raster_of<Dim>(size));
  for (std::size_t p = 0; p < image.values().size(); ++p) {
    image.values()[p] = static_cast<float>(std::sin(0.7 * static_cast<double>(p % 1013)));
  }
  return image;
}

/// A cubic basis with as many spans along the first axis.
template <int Dim>
std::shared_ptr<const TensorBSplineBasis<Dim>> tensor_basis(const Raster<Dim>& raster, int spans) {
  return std::make_shared<TensorBSplineBasis<Dim>>(
      covering_lattice(raster, static_cast<double>(raster.size[0]) / spans));
}

/// Coordinates between -size and size mm.
template <int Dim>
ControlPoints<Dim> random_control_points(const SplineBasis<Dim>& basis, double size = 3) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(-size, size);
  return ControlPoints<Dim>::NullaryExpr(Dim, basis.num_control_points(),
                                         [&] { return uniform(engine); });
}

/// 1024 points on a raster of pixels of 1 mm.
template <int Dim>
std::vector<Point<Dim>> scattered_points(const Raster<Dim>& raster) {
  std::mt19937 engine(3);
  std::vector<Point<Dim>> points(1024);
  for (auto& p : points) {
    for (int a = 0; a < Dim; ++a) {
      p[a] = std::uniform_real_distribution<double>(1, raster.size[a] - 2)(engine);
    }
  }
  return points;
}

/// Over the raster: cells, each cut into two triangles, with their inner corners moved at random.
/// @param alpha  how far the knots spread (KnotOptions).
KnotNet<2> jittered_net(const Raster<2>& raster, const std::array<int, 2>& cells, int degree,
                        double alpha);

}  // namespace crease::benchmarks
