#pragma once

#include <functional>
#include <type_traits>

#include "Images/Interpolator.h"

namespace crease {

/// Where a point of the raster goes, mm to mm.
template <int Dim>
using PointMap = std::function<Point<Dim>(const Point<Dim>&)>;

/// Where the samples of one row of the raster go, a whole row at a time: for bound grids and fields.
/// May write displacements to the buffers (at least size[0] + 16 entries each) and point to them.
/// Samples outside begin .. end get the outside value.
template <int Dim>
using RowMap =
    std::function<MappedRow<Dim>(std::int64_t row, const std::array<float*, Dim>& buffers)>;

/// x -> x + u(x) on the field's own raster. The field must stay alive.
template <int Dim>
RowMap<Dim> row_map(const DisplacementField<Dim>& field);

/// moving(map(x)) for every sample x of the raster; `outside` where map(x) is not inside. Maps are
/// called from several threads.
template <int Dim>
Image<float, Dim> resample(const Interpolator<Dim>& moving, const Raster<Dim>& raster,
                           const std::type_identity_t<PointMap<Dim>>& map, float outside = 0);
template <int Dim>
Image<float, Dim> resample(const Interpolator<Dim>& moving, const Raster<Dim>& raster,
                           const std::type_identity_t<RowMap<Dim>>& map, float outside = 0);

/// The same with the pixel that is nearest to map(x): for labels and masks.
template <typename Pixel, int Dim>
Image<Pixel, Dim> resample_nearest(const Image<Pixel, Dim>& moving, const Raster<Dim>& raster,
                                   const std::type_identity_t<PointMap<Dim>>& map,
                                   std::type_identity_t<Pixel> outside = Pixel());
template <typename Pixel, int Dim>
Image<Pixel, Dim> resample_nearest(const Image<Pixel, Dim>& moving, const Raster<Dim>& raster,
                                   const std::type_identity_t<RowMap<Dim>>& map,
                                   std::type_identity_t<Pixel> outside = Pixel());

}  // namespace crease
