#pragma once

#include <vector>

#include "Core/Raster.h"
#include "Transforms/Transform.h"

namespace crease {

/// |E|_F, E = 1/2 (F^T F - I) the Green-St. Venant strain of the gradient F = grad T: how far T is from
/// moving the tissue there rigidly; no unit.
template <int Dim>
double strain_norm(const Matrix<Dim>& gradient) {
  return 0.5 * (gradient.transpose() * gradient - Matrix<Dim>::Identity()).norm();
}

/// strain_norm() per sample of a raster. In parallel, the same on any number of threads.
template <int Dim>
std::vector<double> strain_map(const Transform<Dim>& transform, const Raster<Dim>& raster);

}  // namespace crease
