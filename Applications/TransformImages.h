#pragma once

#include "Images/Image.h"
#include "Transforms/JacobianMap.h"
#include "Transforms/Transform.h"

namespace crease {

/// T(x) - x at every sample, as an image.
template <int Dim>
DisplacementField<Dim> displacement_image(const Transform<Dim>& transform,
                                          const Raster<Dim>& raster);

/// det grad T at every sample, as an image.
template <int Dim>
Image<float, Dim> determinant_image(const JacobianMap<Dim>& map);

}  // namespace crease
