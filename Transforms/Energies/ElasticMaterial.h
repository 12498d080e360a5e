#pragma once

#include <map>

namespace crease {

/// How stress follows from strain; formulas in StoredEnergy.h.
enum class ElasticLaw {
  kStVenantKirchhoff,  ///< linear in the Green-St. Venant strain; softens in compression
  kNeoHookean          ///< infinite energy where the map would fold
};

/// What a plane map says about the third direction.
enum class PlaneState {
  kStress,  ///< free to grow thicker and thinner: a compressed breast's projection
  kStrain   ///< held
};

/// Young's modulus and Poisson's ratio of one tissue.
struct ElasticTissue {
  double young = 1;        ///< any unit of stress: without forces only ratios matter
  double poisson = 0.495;  ///< above -1, below 0.5
};

/// Stress = lambda tr(strain) I + 2 mu strain, for small strains.
struct LameParameters {
  double lambda, mu;  ///< in the unit of Young's modulus
};

/// What the parts of a domain are made of.
/// Source: dissertation, chapter 4, with (4.1).
struct ElasticMaterial {
  ElasticLaw law = ElasticLaw::kStVenantKirchhoff;
  PlaneState plane = PlaneState::kStress;  ///< in 2D; in 3D there is nothing to choose
  /// Takes the change of volume by its mean over each patch, so that splines of low degree do not lock
  /// where nu is nearly 0.5.
  bool mean_dilatation = false;
  ElasticTissue tissue;                  ///< of regions that are not named below
  std::map<int, ElasticTissue> regions;  ///< by region label of the basis' patches

  const ElasticTissue& of(int region) const;
};

/// mu = E / (2 (1 + nu)); plane strain and 3D: lambda = E nu / ((1 + nu)(1 - 2 nu)); plane stress: the
/// lambda that leaves no stress in the third direction, 2 lambda mu / (lambda + 2 mu) = E nu / (1 - nu^2).
/// @throws InvalidInput unless E > 0 and -1 < nu < 0.5, in plane strain nu <= 0.499.
LameParameters lame_parameters(const ElasticTissue& tissue, PlaneState plane);

/// @throws InvalidInput as lame_parameters(), naming the region.
void check_material(const ElasticMaterial& material);

}  // namespace crease
