#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "Registration/Phantoms/PhantomParts.h"
#include "Transforms/Splines/TensorBSplineBasis.h"

namespace crease {
namespace {

template <int Dim>
using Map = std::function<Point<Dim>(const Point<Dim>&)>;

template <int Dim>
struct Blob {
  Point<Dim> center;
  double deviation;  // mm
  double height;
};

template <int Dim>
std::vector<Blob<Dim>> draw_blobs(int size, Random random) {
  std::vector<Blob<Dim>> blobs(Dim == 2 ? 40 : 160);
  for (auto& blob : blobs) {
    for (double& x : blob.center) x = size * random.uniform(0.05, 0.95);
    blob.deviation = size * random.uniform(0.015, 0.05);
    blob.height = random.uniform(0.1, 0.35) * (random.uniform() < 0.3 ? -1 : 1);
  }
  return blobs;
}

// Evenly distributed in the unit disc or ball.
Vector<2> draw_in_ball(Random& random, const Vector<2>&) {
  const double radius = std::sqrt(random.uniform());
  const double angle = 2 * std::numbers::pi * random.uniform();
  return radius * Vector<2>(std::cos(angle), std::sin(angle));
}
Vector<3> draw_in_ball(Random& random, const Vector<3>&) {
  const double radius = std::cbrt(random.uniform());
  const double angle = 2 * std::numbers::pi * random.uniform();
  const double z = random.uniform(-1, 1), ring = std::sqrt(1 - z * z);
  return radius * Vector<3>(ring * std::cos(angle), ring * std::sin(angle), z);
}

template <int Dim>
ControlPoints<Dim> draw_control_points(int count, Random random) {
  ControlPoints<Dim> points(Dim, count);
  for (int i = 0; i < count; ++i) points.col(i) = draw_in_ball(random, Vector<Dim>());
  return points;
}

// x + u(x), u a spline in the lattice's domain and continued by its value at the nearest point
// outside.
template <int Dim>
Map<Dim> spline_map(const std::shared_ptr<const TensorBSplineBasis<Dim>>& basis,
                    const ControlPoints<Dim>& control_points) {
  return [basis, control_points](const Point<Dim>& x) {
    const auto b = basis->evaluate(basis->contains(x) ? x : basis->nearest_point(x));
    Point<Dim> y = x;
    for (std::size_t k = 0; k < b.control_points.size(); ++k) {
      y += b.values[k] * control_points.col(b.control_points[k]);
    }
    return y;
  };
}

template <int Dim>
double largest_displacement(const DisplacementField<Dim>& field) {
  double largest = 0;
  for (const auto& u : field.values()) largest = std::max(largest, u.norm());
  return largest;
}

template <int Dim>
void scale(DisplacementField<Dim>& field, double factor) {
  for (auto& u : field.values()) u *= factor;
}

// Sets truth and displacement: at most 4 % of the width, less where that would nearly fold.
// @return the smallest and the largest determinant.
template <int Dim>
std::pair<double, double> draw_warp(PhantomImages<Dim>& phantom, const PhantomOptions& options) {
  constexpr double kLargestShare = 0.04, kSmallestDeterminant = 0.3;
  const Raster<Dim> raster = phantom_raster<Dim>(options.size);
  const auto basis = std::make_shared<const TensorBSplineBasis<Dim>>(
      covering_lattice<Dim>(raster, options.size / 8.0), 3);
  ControlPoints<Dim> control_points = draw_control_points<Dim>(
      basis->num_control_points(), random_stream(options, Stream::kMotion));
  phantom.displacement = displacement_of<Dim>(raster, spline_map<Dim>(basis, control_points));
  double factor = kLargestShare * options.size / largest_displacement(phantom.displacement);
  std::pair<double, double> determinants;
  for (;; factor = 0.9) {
    control_points *= factor;
    scale(phantom.displacement, factor);
    determinants = determinant_range(phantom.displacement);
    if (determinants.first > kSmallestDeterminant) break;
  }
  phantom.truth = spline_map<Dim>(basis, control_points);
  return determinants;
}

template <int Dim>
void draw_phantom(PhantomImages<Dim>& phantom, const PhantomOptions& options) {
  phantom.kind = "blobs";
  const auto determinants = draw_warp(phantom, options);
  const auto blobs = draw_blobs<Dim>(options.size, random_stream(options, Stream::kObjects));
  const auto texture = make_texture<Dim>(options);
  const auto scene = [&](const Point<Dim>& y) {
    constexpr double kNothing = 80;  // exp(-40): nothing beside the other greys
    double grey = 0.4 + (texture ? 0.08 * (*texture)(y) : 0);
    for (const auto& blob : blobs) {
      const double r2 = (y - blob.center).squaredNorm() / (blob.deviation * blob.deviation);
      if (r2 < kNothing) grey += blob.height * std::exp(-0.5 * r2);
    }
    return grey;
  };
  const double noise = options.noise.value_or(0);
  sample_images<Dim>(phantom, scene, noise, options);
  phantom.parameters = {{"noise", noise},
                        {"largest_displacement_mm", largest_displacement(phantom.displacement)},
                        {"determinant_min", determinants.first},
                        {"determinant_max", determinants.second}};
}

}  // namespace

Phantom make_blobs_phantom(const PhantomOptions& options) {
  Phantom phantom;
  draw_phantom(phantom, options);
  return phantom;
}

VolumePhantom make_blobs_volume_phantom(const PhantomOptions& options) {
  VolumePhantom phantom;
  draw_phantom(phantom, options);
  return phantom;
}

}  // namespace crease
