#pragma once

#include "Images/Resample.h"
#include "Transforms/Transform.h"

namespace crease {

/// T^-1 of a transform or of a chain: part by part, the last part first; affine parts by their inverse
/// matrix, splines by Newton's method (InverseMap) started from samples of their domain, a quarter of
/// their edge length apart.
///
/// @param transform  must stay alive as long as the result.
/// @return           a map whose values are NaN where no inverse was found: a fold, or a point that the
///                   domain's image does not cover. It may be called from several threads.
/// @throws InvalidInput when an affine part is singular or a part is of another type.
template <int Dim>
PointMap<Dim> inverse_transform(const Transform<Dim>& transform);

extern template PointMap<2> inverse_transform<2>(const Transform<2>&);
extern template PointMap<3> inverse_transform<3>(const Transform<3>&);

}  // namespace crease
