#pragma once

#include <algorithm>

#include "Core/Box.h"
#include "Core/Error.h"
#include "Core/Raster.h"

namespace crease {

/// The domain of a spline with knots of its own per axis: { origin + direction * u : lower <= u <= upper }.
/// Knots are lengths along the axes, so that derivatives by u are per mm.
template <int Dim>
struct ParameterBox {
  Point<Dim> origin = Point<Dim>::Zero();           ///< u = 0, mm
  Matrix<Dim> direction = Matrix<Dim>::Identity();  ///< orthonormal, column = axis
  Vector<Dim> lower = Vector<Dim>::Zero();          ///< first knots, mm
  Vector<Dim> upper = Vector<Dim>::Ones();          ///< last knots, mm

  Vector<Dim> coordinates(const Point<Dim>& x) const {
    return direction.transpose() * (x - origin);
  }
  Point<Dim> point(const Vector<Dim>& u) const { return origin + direction * u; }
  Vector<Dim> clamped(const Vector<Dim>& u) const { return u.cwiseMax(lower).cwiseMin(upper); }

  /// The closed box, a billionth of its size wider against rounding.
  bool contains(const Point<Dim>& x) const {
    const Vector<Dim> u = coordinates(x), slack = kTolerance * (upper - lower);
    return (u.array() >= (lower - slack).array()).all() &&
           (u.array() <= (upper + slack).array()).all();
  }
  /// The coordinates of x, clamped to the box. @throws InvalidInput when x is outside.
  Vector<Dim> inner_coordinates(const Point<Dim>& x, const char* who) const {
    if (!contains(x)) {
      throw InvalidInput(message(who, ": the point (", x.transpose(),
                                 ") mm lies outside the domain, whose axes run from (",
                                 lower.transpose(), ") to (", upper.transpose(), ") mm; it is at (",
                                 coordinates(x).transpose(), ")."));
    }
    return clamped(coordinates(x));
  }
  Point<Dim> nearest_point(const Point<Dim>& x) const {
    return contains(x) ? x : point(clamped(coordinates(x)));
  }
  Box<Dim> bounds() const {
    Box<Dim> box;
    for (int corner = 0; corner < (1 << Dim); ++corner) {
      Vector<Dim> u;
      for (int a = 0; a < Dim; ++a) u[a] = (corner >> a & 1) ? upper[a] : lower[a];
      box.add(point(u));
    }
    return box;
  }
  double measure() const { return (upper - lower).prod(); }
  /// @throws InvalidInput when the direction is not orthonormal or a number not finite.
  void check(const char* who) const {
    if (!origin.allFinite() || !direction.allFinite() ||
        !(direction.transpose() * direction).isApprox(Matrix<Dim>::Identity(), 1e-6)) {
      throw InvalidInput(
          message(who, ": the origin must be finite and the direction orthonormal."));
    }
  }
  /// The pixels of a raster, half a pixel beyond the outer centres; u = 0 at the first corner.
  static ParameterBox covering(const Raster<Dim>& raster) {
    ParameterBox box;
    box.origin = raster.point(Vector<Dim>::Constant(-0.5));
    box.direction = raster.direction;
    for (int a = 0; a < Dim; ++a) box.upper[a] = raster.size[a] * raster.spacing[a];
    return box;
  }

 private:
  static constexpr double kTolerance = 1e-9;
};

}  // namespace crease
