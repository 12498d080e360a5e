#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "Registration/RegistrationObjective.h"

namespace crease {

/// The names by which a schedule knows the energy that smooths a motion, and so is weighed by the noise:
/// bending, or the energy of an elastic body in its place.
inline constexpr std::string_view kBendingName = "bending", kElasticName = "elastic";

inline bool is_smoothing(std::string_view name) {
  return name == kBendingName || name == kElasticName;
}

/// The first energy that smooths; null: none.
template <int Dim>
WeightedEnergy<Dim>* smoothing_energy(std::vector<WeightedEnergy<Dim>>& energies) {
  const auto found =
      std::ranges::find_if(energies, [](const auto& energy) { return is_smoothing(energy.name); });
  return found == energies.end() ? nullptr : &*found;
}

}  // namespace crease
