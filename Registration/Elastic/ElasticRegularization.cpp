#include "Registration/Elastic/ElasticRegularization.h"

#include "Core/Error.h"
#include "Transforms/Energies/ElasticEnergy.h"

namespace crease {

template <int Dim>
EnergyFactory<Dim> elastic(const ElasticMaterial& material,
                           std::function<int(const Point<Dim>&)> region_at) {
  check_material(material);
  if (material.mean_dilatation) {
    throw InvalidInput(
        "elastic energy: a mean dilatation couples all control points of a patch, for which a "
        "registration has no room; leave it out.");
  }
  ElasticMaterial relative = material;
  for (auto& [region, tissue] : relative.regions) tissue.young /= material.tissue.young;
  relative.tissue.young = 1;
  return [relative, region_at](const SplineBasis<Dim>& basis, const AffineMap<Dim>& affine) {
    ElasticOptions<Dim> options;
    // Exact for small strains: a regulariser need not be more, and all of a quartic energy takes several times as long.
    options.quadrature_degree = basis.product_degree(2, 1);
    options.region_at = region_at;
    return std::make_shared<ElasticEnergy<Dim>>(basis, relative, affine, options);
  };
}

template EnergyFactory<2> elastic<2>(const ElasticMaterial&, std::function<int(const Point<2>&)>);
template EnergyFactory<3> elastic<3>(const ElasticMaterial&, std::function<int(const Point<3>&)>);

}  // namespace crease
