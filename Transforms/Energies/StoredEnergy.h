#pragma once

#include "Core/Point.h"
#include "Transforms/Energies/ElasticMaterial.h"

namespace crease {

/// What an elastic law says where the gradient of the map is F, J = det F:
///
///     St. Venant-Kirchhoff   W = lambda/2 tr(E)^2 + mu |E|^2,   E = 1/2 (F^T F - I),
///                            S = lambda tr(E) I + 2 mu E,   P = F S
///     neo-Hookean            W = mu/2 (|F|^2 - Dim - 2 ln J) + lambda/2 (ln J)^2,
///                            P = mu (F - F^-T) + lambda ln J F^-T
///
/// P = dW/dF is the first, S = F^-1 P the second Piola-Kirchhoff stress, J^-1 P F^T Cauchy's. Both laws agree
/// for small strains. Stresses have the unit of Young's modulus.
/// Source: dissertation, (4.1); J. Bonet, R. D. Wood, "Nonlinear Continuum Mechanics for Finite Element
/// Analysis", 2nd edition, Cambridge 2008, 6.4.3.
template <int Dim>
struct ElasticState {
  double energy = 0;                               ///< W
  double determinant = 1;                          ///< J, 1 where volume is kept
  Matrix<Dim> strain = Matrix<Dim>::Zero();        ///< E
  Matrix<Dim> piola_stress = Matrix<Dim>::Zero();  ///< S
  Matrix<Dim> cauchy_stress = Matrix<Dim>::Zero();
};

/// @param region  label that chooses the tissue. A mean dilatation is that of one point here.
/// @throws InvalidInput as lame_parameters(). Neo-Hookean tissue with J <= 0 has infinite energy.
template <int Dim>
ElasticState<Dim> elastic_state(const ElasticMaterial& material, int region, const Matrix<Dim>& F);

extern template ElasticState<2> elastic_state<2>(const ElasticMaterial&, int, const Matrix<2>&);
extern template ElasticState<3> elastic_state<3>(const ElasticMaterial&, int, const Matrix<3>&);

}  // namespace crease
