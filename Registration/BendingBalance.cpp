#include "Registration/BendingBalance.h"

#include <algorithm>
#include <limits>

namespace crease {

double BendingBalance::noise_density() const {
  if (combined_density) return *combined_density;
  if (noise_power) return *noise_power * correlated_measure;
  constexpr double kLeastShare = 0.2;  // of the samples that is left to tell noise by
  const double left = std::max(counted_measure - correlated_measure * determined_parameters,
                               kLeastShare * counted_measure);
  return left > 0 ? 2 * image_energy / left * correlated_measure
                  : std::numeric_limits<double>::infinity();
}

double BendingBalance::weight() const {
  constexpr double kCaution = 1.5;  // true motions are smoother than random ones of the same energy
  return bending_energy > 0
             ? kCaution * 0.5 * noise_density() * determined_parameters / bending_energy
             : std::numeric_limits<double>::infinity();
}

BendingBalance combined(std::span<const BendingBalance> channels, std::span<const double> weights) {
  if (channels.size() == 1 && weights.front() == 1) return channels.front();
  BendingBalance all;
  double noise = 0, powers = 0;
  bool known = true;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const BendingBalance& channel = channels[c];
    all.image_energy += weights[c] * channel.image_energy;
    all.counted_measure += channel.counted_measure;
    all.determined_parameters += channel.determined_parameters;
    noise += weights[c] * channel.noise_density() * channel.determined_parameters;
    known = known && channel.noise_power;
    powers += channel.noise_power.value_or(0) / static_cast<double>(channels.size());
  }
  all.correlated_measure = channels.front().correlated_measure;
  if (known) all.noise_power = powers;
  all.combined_density = all.determined_parameters > 0 ? noise / all.determined_parameters
                                                       : channels.front().noise_density();
  return all;
}

}  // namespace crease
