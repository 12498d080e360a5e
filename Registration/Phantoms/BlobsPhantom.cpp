#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "Registration/Phantoms/PhantomParts.h"
#include "Transforms/Splines/TensorBSplineBasis.h"

namespace crease {
namespace {

struct Blob {
  Point<2> center;
  double deviation;  // mm
  double height;
};

std::vector<Blob> draw_blobs(int size, Random random) {
  std::vector<Blob> blobs(40);
  for (auto& blob : blobs) {
    for (double& x : blob.center) x = size * random.uniform(0.05, 0.95);
    blob.deviation = size * random.uniform(0.015, 0.05);
    blob.height = random.uniform(0.1, 0.35) * (random.uniform() < 0.3 ? -1 : 1);
  }
  return blobs;
}

// Control points evenly distributed in the unit disc.
ControlPoints<2> draw_control_points(int count, Random random) {
  ControlPoints<2> points(2, count);
  for (int i = 0; i < count; ++i) {
    const double radius = std::sqrt(random.uniform());
    const double angle = 2 * std::numbers::pi * random.uniform();
    points.col(i) = radius * Vector<2>(std::cos(angle), std::sin(angle));
  }
  return points;
}

// x + u(x), u a spline in the lattice's domain and continued by its value at the nearest point
// outside.
std::function<Point<2>(const Point<2>&)> spline_map(
    const std::shared_ptr<const TensorBSplineBasis<2>>& basis,
    const ControlPoints<2>& control_points) {
  return [basis, control_points](const Point<2>& x) {
    const auto b = basis->evaluate(basis->contains(x) ? x : basis->nearest_point(x));
    Point<2> y = x;
    for (std::size_t k = 0; k < b.control_points.size(); ++k) {
      y += b.values[k] * control_points.col(b.control_points[k]);
    }
    return y;
  };
}

double largest_displacement(const DisplacementField<2>& field) {
  double largest = 0;
  for (const auto& u : field.values()) largest = std::max(largest, u.norm());
  return largest;
}

}  // namespace

// A smooth warp without bodies
Phantom make_blobs_phantom(const PhantomOptions& options) {
  constexpr double kLargestShare = 0.04, kSmallestDeterminant = 0.3;
  const Raster<2> raster = phantom_raster(options.size);
  const auto basis =
      std::make_shared<TensorBSplineBasis<2>>(covering_lattice<2>(raster, options.size / 8.0), 3);
  ControlPoints<2> control_points =
      draw_control_points(basis->num_control_points(), random_stream(options, Stream::kMotion));
  control_points *=
      kLargestShare * options.size /
      largest_displacement(sample_displacement(raster, spline_map(basis, control_points)));
  Phantom phantom;
  phantom.kind = "blobs";
  std::pair<double, double> determinants;
  do {
    phantom.truth = spline_map(basis, control_points);
    phantom.displacement = sample_displacement(raster, phantom.truth);
    determinants = determinant_range(phantom.displacement);
    control_points *= 0.9;
  } while (determinants.first <= kSmallestDeterminant);

  const auto blobs = draw_blobs(options.size, random_stream(options, Stream::kObjects));
  const auto texture = make_texture(options);
  const auto scene = [&](const Point<2>& y) {
    double grey = 0.4 + (texture ? 0.08 * (*texture)(y) : 0);
    for (const auto& blob : blobs) {
      const double r2 = (y - blob.center).squaredNorm() / (blob.deviation * blob.deviation);
      grey += blob.height * std::exp(-0.5 * r2);
    }
    return grey;
  };
  const double noise = options.noise.value_or(0);
  sample_images(phantom, scene, noise, options);
  phantom.parameters = {{"noise", noise},
                        {"largest_displacement_mm", largest_displacement(phantom.displacement)},
                        {"determinant_min", determinants.first},
                        {"determinant_max", determinants.second}};
  return phantom;
}

}  // namespace crease
