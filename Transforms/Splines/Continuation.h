#pragma once

#include "Core/Point.h"

namespace crease {

/// How a spline u goes on outside its domain, from the domain's point p nearest to x:
///
///     u(x) = u(p) + s grad u(p) (x - p),     s = R / (R + |x - p|),
///
/// with the gradient of p at first, but never farther along it than R, a quarter of the patches' mean edge
/// length. A gradient that is followed for long carries small differences between neighbours far away, and
/// such maps fold.
template <int Dim>
struct Continuation {
  /// s (x - p), mm.
  Vector<Dim> step;
  /// d step / dx where p follows x along a straight border: grad u (x) = grad u(p) stretch.
  Matrix<Dim> stretch;

  /// @param away         x - p, mm.
  /// @param edge_length  the mean one, mm.
  Continuation(const Vector<Dim>& away, double edge_length) {
    const double reach = edge_length / 4;
    const double distance = away.norm();
    const double s = reach / (reach + distance);
    step = s * away;
    stretch.setIdentity();
    if (distance == 0) return;
    const Vector<Dim> direction = away / distance;
    stretch -= (1 - s * s) * direction * direction.transpose();
  }
};

}  // namespace crease
