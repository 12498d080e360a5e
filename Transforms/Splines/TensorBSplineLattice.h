#pragma once

#include <array>

#include "Core/Point.h"

namespace crease {

/// A box of knot spans, turned in space: the domain of a tensor-product B-spline is
/// { origin + direction * (spacing .* t) : 0 <= t_a <= spans_a }, in mm.
template <int Dim>
struct TensorLattice {
  std::array<int, Dim> spans{};                     ///< knot spans per axis, at least 1
  Point<Dim> origin = Point<Dim>::Zero();           ///< corner of the domain, mm
  Vector<Dim> spacing = Vector<Dim>::Ones();        ///< size of a span, mm
  Matrix<Dim> direction = Matrix<Dim>::Identity();  ///< orthonormal, column = axis

  /// t of the formula above.
  Vector<Dim> coordinates(const Point<Dim>& x) const {
    return spacing.cwiseInverse().asDiagonal() * (direction.transpose() * (x - origin));
  }
  Point<Dim> point(const Vector<Dim>& t) const {
    return origin + direction * (spacing.asDiagonal() * t);
  }
};

}  // namespace crease
