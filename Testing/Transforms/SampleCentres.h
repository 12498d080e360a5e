#pragma once

#include <cmath>
#include <memory>

#include "Transforms/Splines/ThinPlateBasis.h"

namespace crease::testing {

/// Centres near a lattice over a box, `count` along each axis.
template <int Dim>
ControlPoints<Dim> jittered_centres(const Box<Dim>& box, int count) {
  int total = 1;
  for (int a = 0; a < Dim; ++a) total *= count;
  ControlPoints<Dim> centres(Dim, total);
  for (int n = 0; n < total; ++n) {
    for (int a = 0, rest = n; a < Dim; rest /= count, ++a) {
      const double shift = 0.2 * std::sin(2.3 * n + 1.7 * a);
      centres(a, n) = box.lower[a] + (rest % count + 0.5 + shift) * box.size()[a] / count;
    }
  }
  return centres;
}

template <int Dim>
std::shared_ptr<const ThinPlateBasis<Dim>> thin_plates_over(const Box<Dim>& box, int count) {
  return std::make_shared<ThinPlateBasis<Dim>>(jittered_centres<Dim>(box, count), box);
}

}  // namespace crease::testing
