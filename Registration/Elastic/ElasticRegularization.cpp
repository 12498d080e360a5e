#include "Registration/Elastic/ElasticRegularization.h"

#include "Transforms/Energies/ElasticEnergy.h"

namespace crease {
namespace {

/// A regulariser in space is integrated less exactly: a quartic energy of cubics takes five times as many points.
template <int Dim>
int regularization_degree(const SplineBasis<Dim>& basis) {
  return Dim == 3 ? basis.product_degree(2, 1) : -1;
}

}  // namespace

template <int Dim>
EnergyFactory<Dim> elastic(const ElasticMaterial& material,
                           std::function<int(const Point<Dim>&)> region_at) {
  check_material(material);
  ElasticMaterial relative = material;
  for (auto& [region, tissue] : relative.regions) tissue.young /= material.tissue.young;
  relative.tissue.young = 1;
  return [relative, region_at](const SplineBasis<Dim>& basis, const AffineMap<Dim>& affine) {
    ElasticOptions<Dim> options;
    options.quadrature_degree = regularization_degree(basis);
    options.region_at = region_at;
    return std::make_shared<ElasticEnergy<Dim>>(basis, relative, affine, options);
  };
}

template EnergyFactory<2> elastic<2>(const ElasticMaterial&, std::function<int(const Point<2>&)>);
template EnergyFactory<3> elastic<3>(const ElasticMaterial&, std::function<int(const Point<3>&)>);

}  // namespace crease
