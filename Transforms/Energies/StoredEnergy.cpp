#include "Transforms/Energies/StoredEnergy.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace crease {

template <int Dim>
ElasticState<Dim> elastic_state(const ElasticMaterial& material, int region, const Matrix<Dim>& F) {
  const auto [lambda, mu] =
      lame_parameters(material.of(region), Dim == 3 ? PlaneState::kStrain : material.plane);
  const Matrix<Dim> I = Matrix<Dim>::Identity();
  const double J = F.determinant();
  ElasticState<Dim> state;
  state.determinant = J;
  state.strain = 0.5 * (F.transpose() * F - I);
  if (material.law == ElasticLaw::kStVenantKirchhoff) {
    const double trace = state.strain.trace();
    state.energy = 0.5 * lambda * trace * trace + mu * state.strain.squaredNorm();
    state.piola_stress = lambda * trace * I + 2 * mu * state.strain;
  } else if (J > 0) {
    const double log_J = std::log(J);
    state.energy = 0.5 * mu * (F.squaredNorm() - Dim) - mu * log_J + 0.5 * lambda * log_J * log_J;
    state.piola_stress = mu * I + (lambda * log_J - mu) * (F.transpose() * F).inverse();
  } else {
    state.energy = std::numeric_limits<double>::infinity();
    return state;
  }
  state.cauchy_stress = F * state.piola_stress * F.transpose() / J;
  return state;
}

template ElasticState<2> elastic_state<2>(const ElasticMaterial&, int, const Matrix<2>&);
template ElasticState<3> elastic_state<3>(const ElasticMaterial&, int, const Matrix<3>&);

}  // namespace crease
