#pragma once

#include <vector>

#include "Registration/BendingBalance.h"
#include "Registration/RegistrationObjective.h"

namespace crease {

/// Weighs the energies named "bending" (or "elastic") and "landmarks" (the soft ones) anew after each minimisation of a
/// registration's levels: by the noise and the roughness that it shows, and bending more where the finest
/// map folds. Coarser levels choose for the next one; the finest one is minimised again while its weights
/// still change much.
template <int Dim>
class AdaptedWeights {
 public:
  /// @param landmark_weight  of soft landmarks beside images whose noise has the density 1.
  /// @param edge_length      mean over the mesh, mm: the range of the weight of bending goes with its square.
  AdaptedWeights(double landmark_weight, double edge_length)
      : landmark_weight_(landmark_weight), edge_length_(edge_length) {}

  /// After a minimisation of the finest level whose map folds.
  /// @return whether another one, with more bending, is worth its time.
  bool stiffen(std::vector<WeightedEnergy<Dim>>& energies);
  /// After any other minimisation.
  /// @return whether the finest level is worth another one.
  bool balance(const BendingBalance& found, bool finest,
               std::vector<WeightedEnergy<Dim>>& energies);
  /// How often the weights have been balanced.
  int num_balancings() const { return balanced_; }

 private:
  double landmark_weight_, edge_length_;
  int balanced_ = 0, stiffened_ = 0;
};

extern template class AdaptedWeights<2>;
extern template class AdaptedWeights<3>;

}  // namespace crease
