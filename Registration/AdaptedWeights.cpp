#include "Registration/AdaptedWeights.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "Registration/SmoothingEnergy.h"

namespace crease {
namespace {

constexpr int kMostBalancings = 6;   // coarser levels included
constexpr int kMostStiffenings = 4;  // of a map that folds
constexpr double kStiffening = 4;
constexpr double kLeastBending =
    1e-6;  // times the square of the mean edge; of an elastic body as it is
constexpr double kMostBending = 1e-1;  // likewise
constexpr double kLeastNoise = 1e-6;   // beside which soft landmarks are weighed
constexpr double kMostFall = 32;       // of the weight of bending at once
constexpr double kMostRise = 4;

template <int Dim>
WeightedEnergy<Dim>* find(std::vector<WeightedEnergy<Dim>>& energies, std::string_view name) {
  const auto found = std::ranges::find(energies, name, &WeightedEnergy<Dim>::name);
  return found == energies.end() ? nullptr : &*found;
}

/// Sets a weight unless the change is too small for another minimisation of the finest level.
template <int Dim>
bool set_weight(WeightedEnergy<Dim>& energy, double weight, bool finest) {
  constexpr double kSmallChange = 2;
  if (finest && weight < kSmallChange * energy.weight && weight > energy.weight / kSmallChange) {
    return false;
  }
  energy.weight = weight;
  return true;
}

}  // namespace

template <int Dim>
bool AdaptedWeights<Dim>::stiffen(std::vector<WeightedEnergy<Dim>>& energies) {
  WeightedEnergy<Dim>* bending = smoothing_energy(energies);
  if (bending == nullptr || stiffened_ == kMostStiffenings) return false;
  ++stiffened_;
  bending->weight *= kStiffening;
  return true;
}

template <int Dim>
bool AdaptedWeights<Dim>::balance(const BendingBalance& found, bool finest,
                                  std::vector<WeightedEnergy<Dim>>& energies) {
  WeightedEnergy<Dim>* bending = smoothing_energy(energies);
  if (bending == nullptr || stiffened_ > 0 || balanced_ == kMostBalancings) return false;
  ++balanced_;
  const double change = found.weight() / bending->weight;
  // A coarse level that shows little motion must not keep the finer ones from moving, least where the metric
  // tells noise from misfit by itself and would not find the way back.
  const double most_rise = finest || !found.noise_power ? kMostRise : 1.0;
  const double wanted = bending->weight * std::clamp(change, 1 / kMostFall, most_rise);
  // Bending counts second derivatives, an elastic body first ones.
  const double unit = bending->name == kElasticName ? 1 : std::pow(edge_length_, 2);
  bool changed =
      set_weight(*bending, std::clamp(wanted, kLeastBending * unit, kMostBending * unit), finest);
  if (WeightedEnergy<Dim>* landmarks = find(energies, "landmarks")) {
    const double density = std::clamp(found.noise_density(), kLeastNoise, 1.0);
    changed |= set_weight(*landmarks, landmark_weight_ * density, finest);
  }
  return changed && finest;
}

template class AdaptedWeights<2>;
template class AdaptedWeights<3>;

}  // namespace crease
