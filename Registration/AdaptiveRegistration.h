#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "Registration/FinerPlaces.h"
#include "Registration/Registration.h"

namespace crease {

/// A registration whose patches are divided where the images ask for it.
template <int Dim>
struct AdaptiveComposition {
  using Basis = std::shared_ptr<const SplineBasis<Dim>>;
  /// Makes a basis with patches no larger than asked for in these places; none at first.
  std::function<Basis(const std::vector<FinerPlace<Dim>>&)> make_basis;
  /// The registration in such a basis, with all its parts.
  std::function<Registration<Dim>(const Basis&)> compose;
  int most_rounds = 3;
};

/// What one round of dividing patches brought.
struct RefinementRound {
  int control_points = 0;
  int places = 0;            ///< that asked for finer patches
  double expected_gain = 0;  ///< sum of theirs
  double cost_before = 0;    ///< the coarser minimum
  double cost = 0;           ///< the finer one
  bool kept = true;          ///< false: the cost did not fall, the coarser map stays
};

template <int Dim>
struct AdaptiveResult {
  RegistrationResult<Dim> registration;  ///< the last that was kept; warnings of all
  std::vector<RefinementRound> rounds;
};

/// Registers, looks where the residual force asks for finer patches (finer_places), divides them, carries the
/// map over and goes on, until nothing significant is asked for, the gain expected is below a five-hundredth of the cost, or
/// the rounds are over. The weights are those that the first registration has found. A round that does not
/// lower the cost is taken back, so that it never rises by refining.
///
/// Source: registration 5 (refinement and transfer), Doerfler's marking (SIAM J. Numer. Anal. 33, 1996).
template <int Dim>
AdaptiveResult<Dim> register_adaptively(const AdaptiveComposition<Dim>& composition,
                                        const RegistrationCallback& progress = {});

extern template AdaptiveResult<2> register_adaptively<2>(const AdaptiveComposition<2>&,
                                                         const RegistrationCallback&);

}  // namespace crease
