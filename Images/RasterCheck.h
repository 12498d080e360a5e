#pragma once

#include <string>
#include <string_view>

#include "Core/Raster.h"

namespace crease {

/// @throws InvalidInput unless every size is at least 1, origin and spacing are finite, the spacing is
/// positive and the direction is orthonormal to 1e-6; the message begins with `what`.
template <int Dim>
void check_raster(const Raster<Dim>& raster, std::string_view what);

/// Whether both have the same samples: equal sizes, and no corner apart by more than `tolerance` of
/// the smallest spacing.
template <int Dim>
bool same_raster(const Raster<Dim>& a, const Raster<Dim>& b, double tolerance = 1e-3);

/// For messages: "512 x 400 pixels of 0.5 x 0.5 mm at (0, -12.5) mm".
template <int Dim>
std::string describe(const Raster<Dim>& raster);

extern template void check_raster<2>(const Raster<2>&, std::string_view);
extern template void check_raster<3>(const Raster<3>&, std::string_view);
extern template bool same_raster<2>(const Raster<2>&, const Raster<2>&, double);
extern template bool same_raster<3>(const Raster<3>&, const Raster<3>&, double);
extern template std::string describe<2>(const Raster<2>&);
extern template std::string describe<3>(const Raster<3>&);

}  // namespace crease
