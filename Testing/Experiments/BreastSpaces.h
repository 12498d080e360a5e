#pragma once

#include <memory>

#include "Registration/Phantoms/MammogramDeformation.h"
#include "Testing/Experiments/Experiment.h"
#include "Transforms/Domains/DomainMesh.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Energies/ElasticEnergy.h"
#include "Transforms/SplineTransform.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

// Three spaces of quadratic splines on one mesh of the phantom's breast, with one control point per vertex and per
// edge each, and how near to its true motion they come.
namespace crease::experiments {

enum Space {
  kCreases,    ///< triangular B-splines with a crease along the muscle's edge
  kNoCreases,  ///< without one
  kLagrange    ///< Lagrange's elements: all knots at their vertices
};
inline constexpr Space kSpaces[] = {kCreases, kNoCreases, kLagrange};
inline constexpr const char* kSpaceNames[] = {"creases", "no creases", "Lagrange"};

using BreastBasis = std::shared_ptr<const TriangularBSplineBasis<2>>;
BreastBasis basis_on(const DomainMesh& mesh, Space space, BorderRule border = BorderRule::kOutside);

/// That of the phantom's body: only the spaces differ.
ElasticMaterial breast_material();

/// Differences from the true map at points 1 mm apart in the breast.
struct MapError {
  double rms = 0, band = 0, max = 0;  ///< mm; `band`: rms within 5 mm of the muscle's edge
  double gradient_band = 0;           ///< rms there of grad T, Frobenius norm
};
MapError error_of(const SplineTransform<2>& map, const MammogramDeformation& truth);
Json to_json(const MapError& error);

/// The spline nearest to the true displacement in the mean square: what a space can represent.
SplineTransform<2> nearest_spline(const BreastBasis& basis, const MammogramDeformation& truth);

/// The body whose whole border is where the truth is, as nearly as quadratics on the border's edges can say: what a
/// space makes of an inside that elasticity decides. The spaces agree on the border, whose knots are collapsed.
class HeldBreast {
 public:
  HeldBreast(const DomainMesh& mesh, Space space);
  SplineTransform<2> settle(const MammogramDeformation& truth) const;

 private:
  BreastBasis basis_;
  ElasticEnergy<2> energy_;
};

/// How many unknowns a space really has.
struct EffectiveUnknowns {
  int control_points = 0;
  int on_the_line = 0;  ///< functions that do not vanish on all of the muscle's edge
  /// Of the mass matrix, scaled to a diagonal of 1: zero if functions depend on each other.
  double least_eigenvalue = 0;
};
/// @param basis  small: the eigenvalues are those of a dense matrix.
EffectiveUnknowns effective_unknowns(const BreastBasis& basis);

}  // namespace crease::experiments
