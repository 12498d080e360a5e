#include "Registration/BendingBalance.h"

#include <algorithm>
#include <limits>

namespace crease {

double BendingBalance::noise_density() const {
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

}  // namespace crease
