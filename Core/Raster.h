#pragma once

#include <array>
#include <cstdint>

#include "Core/Box.h"
#include "Core/Point.h"

namespace crease {

/// A regular grid of samples in physical space: what an image has besides its pixels.
///
/// Sample (i, j[, k]) lies at origin + direction * (spacing .* (i, j[, k])), in mm (LPS, as ITK); the
/// origin is the centre of the first pixel. Samples are stored with i fastest.
template <int Dim>
struct Raster {
  std::array<int, Dim> size{};                      ///< samples per axis
  Point<Dim> origin = Point<Dim>::Zero();           ///< mm
  Vector<Dim> spacing = Vector<Dim>::Ones();        ///< mm, positive
  Matrix<Dim> direction = Matrix<Dim>::Identity();  ///< orthonormal, column = axis

  std::int64_t num_samples() const {
    std::int64_t n = 1;
    for (int s : size) n *= s;
    return n;
  }
  /// Number of rows: runs of `size[0]` consecutive samples along the first axis.
  std::int64_t num_rows() const { return size[0] == 0 ? 0 : num_samples() / size[0]; }
  /// mm per index step: column a is the step along axis a.
  Matrix<Dim> index_to_point() const { return direction * spacing.asDiagonal(); }
  Matrix<Dim> point_to_index() const {
    return spacing.cwiseInverse().asDiagonal() * direction.transpose();
  }
  Point<Dim> point(const Vector<Dim>& index) const { return origin + index_to_point() * index; }
  Vector<Dim> index(const Point<Dim>& p) const { return point_to_index() * (p - origin); }
  /// The first sample of row r, r = j (2D) or j + size[1] * k (3D).
  Point<Dim> row_start(std::int64_t r) const {
    Vector<Dim> i = Vector<Dim>::Zero();
    i[1] = static_cast<double>(Dim == 2 ? r : r % size[1]);
    if constexpr (Dim == 3) {
      const std::int64_t k = r / size[1];
      i[2] = static_cast<double>(k);
    }
    return point(i);
  }
  /// Area (2D, mm^2) or volume (3D, mm^3) of one sample.
  double sample_volume() const { return spacing.prod(); }
  /// The box of all pixels, half a pixel beyond the outer centres, in mm.
  Box<Dim> bounds() const {
    Box<Dim> box;
    for (int corner = 0; corner < (1 << Dim); ++corner) {
      Vector<Dim> i;
      for (int a = 0; a < Dim; ++a) i[a] = (corner >> a & 1) ? size[a] - 0.5 : -0.5;
      box.add(point(i));
    }
    return box;
  }
};

}  // namespace crease
