#include "Transforms/Splines/CoveringCentres.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "Core/Error.h"

namespace crease {
namespace {

constexpr double kNear = 0.25;  // of their distance: lattice points left out beside landmarks
constexpr double kSame = 1e-6;  // of the length: landmarks this near to each other are one

/// Lattice points per axis, two at least.
template <int Dim>
std::array<int, Dim> lattice_counts(const Vector<Dim>& extent, double length) {
  while (true) {
    std::array<int, Dim> counts;
    int product = 1;
    for (int a = 0; a < Dim; ++a) {
      counts[a] = 1 + std::max(1, static_cast<int>(std::lround(std::min(1e4, extent[a] / length))));
      product = std::min(product * counts[a], 1 << 16);
    }
    if (product <= kMostLatticeCentres<Dim>) return counts;
    length *= 1.01;
  }
}

template <int Dim>
bool near_any(const std::vector<Point<Dim>>& points, const Point<Dim>& x, double distance) {
  return std::ranges::any_of(points,
                             [&](const Point<Dim>& p) { return (p - x).norm() <= distance; });
}

}  // namespace

template <int Dim>
ControlPoints<Dim> covering_centres(const Raster<Dim>& raster, double length,
                                    std::span<const Point<Dim>> landmarks) {
  if (raster.num_samples() == 0 || !(length > 0) || !std::isfinite(length)) {
    throw InvalidInput(message("covering_centres: a distance of ", length, " mm on a raster of ",
                               raster.num_samples(), " samples; both must be positive."));
  }
  Vector<Dim> samples;
  for (int a = 0; a < Dim; ++a) samples[a] = raster.size[a];
  const Vector<Dim> extent = samples.cwiseProduct(raster.spacing);
  const std::array<int, Dim> counts = lattice_counts<Dim>(extent, length);

  std::vector<Point<Dim>> marks;
  for (std::size_t j = 0; j < landmarks.size(); ++j) {
    if (!landmarks[j].allFinite()) {
      throw InvalidInput(message("covering_centres: landmark ", j + 1, " is not finite."));
    }
    if (!near_any<Dim>(marks, landmarks[j], kSame * length)) marks.push_back(landmarks[j]);
  }
  double distance = extent[0] / (counts[0] - 1);
  for (int a = 1; a < Dim; ++a) distance = std::min(distance, extent[a] / (counts[a] - 1));
  std::vector<Point<Dim>> centres;
  int total = 1;
  for (int count : counts) total *= count;
  for (int n = 0; n < total; ++n) {
    Vector<Dim> index;
    for (int a = 0, rest = n; a < Dim; rest /= counts[a], ++a) {
      index[a] = samples[a] * (rest % counts[a]) / (counts[a] - 1) - 0.5;
    }
    const Point<Dim> x = raster.point(index);
    if (!near_any<Dim>(marks, x, kNear * distance)) centres.push_back(x);
  }
  centres.insert(centres.end(), marks.begin(), marks.end());
  ControlPoints<Dim> columns(Dim, centres.size());
  for (std::size_t i = 0; i < centres.size(); ++i) columns.col(i) = centres[i];
  return columns;
}

template ControlPoints<2> covering_centres(const Raster<2>&, double, std::span<const Point<2>>);
template ControlPoints<3> covering_centres(const Raster<3>&, double, std::span<const Point<3>>);

}  // namespace crease
