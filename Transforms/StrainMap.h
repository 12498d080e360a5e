#pragma once

#include <vector>

#include "Core/Raster.h"
#include "Transforms/Transform.h"

namespace crease {

/// |E|_F per sample of a raster, E = 1/2 (grad T^T grad T - I) the Green-St. Venant strain: how far T is
/// from moving the tissue there rigidly. In parallel, the same on any number of threads.
template <int Dim>
std::vector<double> strain_map(const Transform<Dim>& transform, const Raster<Dim>& raster);

}  // namespace crease
