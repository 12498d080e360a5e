#pragma once

#include <vector>

#include "Transforms/AffineMap.h"
#include "Transforms/BoundGrid.h"

namespace crease {

/// Sets the weight of every sample to 0 whose mapped point A(x) + u(x) lies outside the moving image's
/// outer pixel centres, or within `margin` of its pixels from them.
template <int Dim>
void keep_samples_inside(const BoundGrid<Dim>& grid, const AffineMap<Dim>& affine,
                         const Eigen::Ref<const ControlPoints<Dim>>& phi, const Raster<Dim>& moving,
                         double margin, std::vector<float>& weights);

extern template void keep_samples_inside<2>(const BoundGrid<2>&, const AffineMap<2>&,
                                            const Eigen::Ref<const ControlPoints<2>>&,
                                            const Raster<2>&, double, std::vector<float>&);
extern template void keep_samples_inside<3>(const BoundGrid<3>&, const AffineMap<3>&,
                                            const Eigen::Ref<const ControlPoints<3>>&,
                                            const Raster<3>&, double, std::vector<float>&);

/// The same for an affine map alone.
template <int Dim>
void keep_samples_inside(const Raster<Dim>& fixed, const AffineMap<Dim>& affine,
                         const Raster<Dim>& moving, double margin, std::vector<float>& weights);

extern template void keep_samples_inside<2>(const Raster<2>&, const AffineMap<2>&, const Raster<2>&,
                                            double, std::vector<float>&);
extern template void keep_samples_inside<3>(const Raster<3>&, const AffineMap<3>&, const Raster<3>&,
                                            double, std::vector<float>&);

/// Sets the weight of every sample to 0 that lies outside the domain of the bound grid.
template <int Dim>
void keep_samples_in_domain(const BoundGrid<Dim>& grid, std::vector<float>& weights);

extern template void keep_samples_in_domain<2>(const BoundGrid<2>&, std::vector<float>&);
extern template void keep_samples_in_domain<3>(const BoundGrid<3>&, std::vector<float>&);

}  // namespace crease
