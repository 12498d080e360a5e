#include "Transforms/Energies/ElasticMaterial.h"

#include <cmath>
#include <string>

#include "Core/Error.h"

namespace crease {
namespace {

constexpr double kLargestPlaneStrainPoisson = 0.499;

/// Empty when all is well.
std::string fault(const ElasticTissue& tissue, PlaneState plane) {
  if (!(tissue.young > 0 && std::isfinite(tissue.young))) {
    return message("Young's modulus E = ", tissue.young, " is not a positive number");
  }
  if (!(tissue.poisson > -1 && tissue.poisson < 0.5)) {
    return message("Poisson's ratio nu = ", tissue.poisson, " does not lie in (-1, 0.5)");
  }
  if (plane == PlaneState::kStrain && tissue.poisson > kLargestPlaneStrainPoisson) {
    return message(
        "Poisson's ratio nu = ", tissue.poisson, " is above ", kLargestPlaneStrainPoisson,
        ", too near to incompressible for plane strain; use plane stress or a smaller nu");
  }
  return {};
}

}  // namespace

const ElasticTissue& ElasticMaterial::of(int region) const {
  const auto found = regions.find(region);
  return found == regions.end() ? tissue : found->second;
}

LameParameters lame_parameters(const ElasticTissue& tissue, PlaneState plane) {
  if (const std::string wrong = fault(tissue, plane); !wrong.empty()) {
    throw InvalidInput(message("elastic material: ", wrong, "."));
  }
  const double E = tissue.young, nu = tissue.poisson;
  const double lambda =
      plane == PlaneState::kStress ? E * nu / (1 - nu * nu) : E * nu / ((1 + nu) * (1 - 2 * nu));
  return {lambda, E / (2 * (1 + nu))};
}

void check_material(const ElasticMaterial& material) {
  if (const std::string wrong = fault(material.tissue, material.plane); !wrong.empty()) {
    throw InvalidInput(message("elastic material: ", wrong, "."));
  }
  for (const auto& [region, tissue] : material.regions) {
    if (const std::string wrong = fault(tissue, material.plane); !wrong.empty()) {
      throw InvalidInput(message("elastic material of region ", region, ": ", wrong, "."));
    }
  }
}

}  // namespace crease
