#pragma once

#include "Images/Image.h"
#include "Transforms/Transform.h"

namespace crease {

/// A transform at every sample of a raster.
template <int Dim>
struct TransformImages {
  DisplacementField<Dim> displacement;  ///< T(x) - x
  Image<float, Dim> determinants;       ///< of grad T
  Image<float, Dim> strain;             ///< strain_norm() of grad T
  Mask<Dim> domain;                     ///< where T is defined by its spline
};
template <int Dim>
TransformImages<Dim> transform_images(const Transform<Dim>& transform, const Raster<Dim>& raster);

}  // namespace crease
