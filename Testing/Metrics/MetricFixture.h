#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "Images/CubicBSplineInterpolator.h"
#include "Metrics/Metric.h"
#include "Metrics/MetricInput.h"

namespace crease::testing {

/// A smooth image without symmetry, values about 0 to 2.
template <int Dim>
Image<float, Dim> waves(const Raster<Dim>& raster, double phase) {
  Image<float, Dim> image(raster);
  for (std::int64_t k = 0; k < raster.num_samples(); ++k) {
    const auto index = image.index(k);
    Vector<Dim> i;
    for (int a = 0; a < Dim; ++a) i[a] = index[a];
    const Point<Dim> x = raster.point(i);
    double value = 1 + 0.4 * std::sin(0.31 * x[0] + 0.17 * x[1] + phase) +
                   0.3 * std::cos(0.23 * x[1] - 0.11 * x[0] + 2 * phase);
    if constexpr (Dim == 3) value += 0.3 * std::sin(0.29 * x[2] + phase);
    image[index] = static_cast<float>(value);
  }
  return image;
}

template <int Dim>
Raster<Dim> test_raster() {
  Raster<Dim> raster;
  raster.size.fill(Dim == 2 ? 37 : 14);
  raster.size[0] += 5;
  raster.spacing[0] = 0.8;
  raster.spacing[1] = 1.3;
  raster.origin.setConstant(-3);
  return raster;
}

/// Samples whose weights vary, and are 0 near the border: what they are mapped to stays inside the
/// moving image, where value and force belong together.
template <int Dim>
MetricInput<Dim> test_input() {
  MetricInput<Dim> input;
  input.fixed = waves<Dim>(test_raster<Dim>(), 0.2);
  input.weights.assign(static_cast<std::size_t>(input.fixed.raster().num_samples()), 1.0f);
  for (std::size_t i = 0; i < input.weights.size(); i += 7) input.weights[i] = 0.5f;
  for (std::size_t i = 3; i < input.weights.size(); i += 11) input.weights[i] = 0.0f;
  for (std::size_t i = 0; i < input.weights.size(); ++i) {
    const auto index = input.fixed.index(static_cast<std::int64_t>(i));
    for (int a = 0; a < Dim; ++a) {
      if (index[a] < 3 || index[a] + 3 >= input.fixed.size()[a]) input.weights[i] = 0;
    }
  }
  input.moving =
      std::make_shared<CubicBSplineInterpolator<Dim>>(waves<Dim>(test_raster<Dim>(), 0.6));
  return input;
}

/// A smooth map of the raster's samples that keeps most of them inside the moving image.
template <int Dim>
std::vector<Point<Dim>> mapped_points(const Raster<Dim>& raster) {
  std::vector<Point<Dim>> points;
  for (std::int64_t k = 0; k < raster.num_samples(); ++k) {
    Vector<Dim> i;
    std::int64_t rest = k;
    for (int a = 0; a < Dim; ++a) {
      i[a] = static_cast<double>(rest % raster.size[a]);
      rest /= raster.size[a];
    }
    Point<Dim> x = raster.point(i);
    const Point<Dim> y = x;
    for (int a = 0; a < Dim; ++a) x[a] += 0.7 * std::sin(0.21 * y[(a + 1) % Dim] + a) + 0.123;
    points.push_back(x);
  }
  return points;
}

}  // namespace crease::testing
