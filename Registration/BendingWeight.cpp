#include "Registration/BendingWeight.h"

#include <limits>

namespace crease {
namespace {

/// Between a seventh and all came out best on smooth, creased, clean and noisy phantoms.
constexpr double kDeterminedShare = 0.35;

}  // namespace

double BendingBalance::weight() const {
  if (!(counted_measure > 0)) return std::numeric_limits<double>::infinity();
  const double density = 2 * image_energy / counted_measure * correlated_measure;
  const double wanted = 0.5 * density * kDeterminedShare * static_cast<double>(free_parameters);
  return bending_energy > 0 ? wanted / bending_energy : std::numeric_limits<double>::infinity();
}

}  // namespace crease
