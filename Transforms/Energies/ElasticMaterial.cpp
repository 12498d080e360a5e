#include "Transforms/Energies/ElasticMaterial.h"

#include <cmath>

#include "Core/Error.h"

namespace crease {

const ElasticTissue& ElasticMaterial::of(int region) const {
  const auto found = regions.find(region);
  return found == regions.end() ? tissue : found->second;
}

LameParameters lame_parameters(const ElasticTissue& tissue, PlaneState plane) {
  const auto [E, nu] = tissue;
  if (!(E > 0) || !std::isfinite(E)) {
    throw InvalidInput(
        message("elastic material: Young's modulus must be above 0; it is ", E, "."));
  }
  if (!(nu > -1 && nu < 0.5)) {
    throw InvalidInput(
        message("elastic material: Poisson's ratio must lie between -1 and 0.5; it is ", nu, "."));
  }
  constexpr double kLargestInPlaneStrain = 0.499;
  if (plane == PlaneState::kStrain && nu > kLargestInPlaneStrain) {
    throw InvalidInput(message("elastic material: plane strain with Poisson's ratio ", nu,
                               " keeps all areas, which no spline can; take at most ",
                               kLargestInPlaneStrain, ", or plane stress."));
  }
  const double mu = E / (2 * (1 + nu));
  if (plane == PlaneState::kStress) return {E * nu / (1 - nu * nu), mu};
  return {E * nu / ((1 + nu) * (1 - 2 * nu)), mu};
}

}  // namespace crease
