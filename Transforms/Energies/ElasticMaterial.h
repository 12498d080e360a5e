#pragma once

#include <map>

namespace crease {

/// How stress follows from strain.
enum class ElasticLaw { kStVenantKirchhoff, kNeoHookean };
/// What a plane body does across its plane: grow thicker and thinner freely, or not at all.
enum class PlaneState { kStress, kStrain };

/// Young's modulus in any unit of stress (only ratios matter without forces), and Poisson's ratio.
struct ElasticTissue {
  double young = 1;
  double poisson = 0.495;
};

/// Lame's parameters, in the unit of Young's modulus.
struct LameParameters {
  double lambda = 0, mu = 0;
};

/// What an elastic body is made of, region by region.
struct ElasticMaterial {
  ElasticLaw law = ElasticLaw::kStVenantKirchhoff;
  PlaneState plane = PlaneState::kStress;  ///< 2D only; 3D uses the three-dimensional parameters
  bool mean_dilatation = false;            ///< volume strains are averaged over each patch
  ElasticTissue tissue;                    ///< of regions that are not named below
  std::map<int, ElasticTissue> regions;    ///< by region label of the basis' patches
  const ElasticTissue& of(int region) const;
};

/// mu = E / (2 (1 + nu)); plane strain and 3D: lambda = E nu / ((1 + nu) (1 - 2 nu)); plane stress:
/// lambda = E nu / (1 - nu^2), which lets the body change its thickness.
/// @throws InvalidInput for E <= 0, nu outside (-1, 0.5), and for plane strain with nu > 0.499.
LameParameters lame_parameters(const ElasticTissue& tissue, PlaneState plane);

}  // namespace crease
