#pragma once

#include "Core/Raster.h"
#include "Transforms/Transform.h"

namespace crease {

/// T(x) - x at every sample of a raster: Dim x num_samples, mm, double precision, in parallel. Outside
/// the transform's domain its continuation.
template <int Dim>
ControlPoints<Dim> displacement_field(const Transform<Dim>& transform, const Raster<Dim>& raster);

}  // namespace crease
