#pragma once

#include <functional>

#include "Registration/Registration.h"
#include "Transforms/Energies/ElasticMaterial.h"

namespace crease {

/// The stored energy of a registration's map (ElasticEnergy) in place of bending: tissue that resists being
/// stretched, softer or stiffer by region. Stiffnesses count relative to that of `material.tissue`, so that
/// weights have no unit of stress. It is integrated exactly for small strains.
/// @throws InvalidInput as check_material(), and for a mean dilatation, which couples what a registration's
/// matrix holds no room for.
/// @param region_at  the region of a point, for bases whose patches have none; null: that of the patch.
template <int Dim>
EnergyFactory<Dim> elastic(const ElasticMaterial& material,
                           std::function<int(const Point<Dim>&)> region_at = nullptr);

/// The weight of the elastic energy from which Schedule::adapt_weights starts, no unit: motions whose strain
/// changes within a mean edge length h are as costly as with default_bending_weight(), 1e-3 h^2.
inline constexpr double kDefaultElasticWeight = 1e-3;

extern template EnergyFactory<2> elastic<2>(const ElasticMaterial&,
                                            std::function<int(const Point<2>&)>);
extern template EnergyFactory<3> elastic<3>(const ElasticMaterial&,
                                            std::function<int(const Point<3>&)>);

}  // namespace crease
