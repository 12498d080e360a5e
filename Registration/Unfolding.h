#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "Transforms/AffineMap.h"
#include "Transforms/Energies/FoldingEnergy.h"
#include "Transforms/InvertibilityCertificate.h"
#include "Transforms/SplineTransform.h"

namespace crease {

/// A map that was made invertible, and how.
template <int Dim>
struct UnfoldingResult {
  Eigen::VectorXd phi;                        ///< stacked control points
  InvertibilityCertificate<Dim> certificate;  ///< of this map
  int rounds = 0;                             ///< minimisations with the energy against folding
  double folding_weight = 0;                  ///< of that energy in the last one
  double share = 1;  ///< of the way from a certified map; 1: the minimum itself
};

/// Leads from a map that folds to one that is certified not to: the energy against folds (FoldingEnergy) joins
/// the cost on the patches where det grad T is low, and its weight rises from round to round until the
/// certificate is there. Where that fails, the map goes back on the straight way towards a certified one
/// within the same constraints: the smoothest map, unfolded without the images if need be. If there is none, as
/// where exact landmarks change sides, the result is the map with the fewest folds, and not certified.
template <int Dim>
class Unfolding {
 public:
  using Phi = Eigen::VectorXd;
  /// The run's cost plus `weight` times the energy, minimised from a map within the constraints.
  using Minimise = std::function<Phi(const std::shared_ptr<const Energy<Dim>>& folding,
                                     double weight, const Phi& start)>;
  struct Costs {
    Minimise with_images;
    Minimise without_images;  ///< the energies alone
    /// With images, without the energy against folds; fills the diagonal of the Hessian if not null.
    std::function<double(const Phi&, Eigen::VectorXd* curvature)> value;
  };

  Unfolding(std::shared_ptr<const SplineBasis<Dim>> basis, const AffineMap<Dim>& affine,
            Costs costs);

  /// @param phi       the minimum, which may fold.
  /// @param smoothest within the constraints.
  UnfoldingResult<Dim> run(const Phi& phi, const Phi& smoothest);

 private:
  InvertibilityCertificate<Dim> certify(const Phi& phi) const;
  void watch(const InvertibilityCertificate<Dim>& certificate);
  double first_weight(const Phi& phi) const;
  void press(const Minimise& minimise, UnfoldingResult<Dim>& result);
  void retreat(const Phi& certified, UnfoldingResult<Dim>& result) const;
  void improve(UnfoldingResult<Dim>& result);

  std::shared_ptr<const SplineBasis<Dim>> basis_;
  AffineMap<Dim> affine_;
  Costs costs_;
  std::vector<char> watched_;  // patches
  double threshold_ = 0.1;     // det below it costs
  std::shared_ptr<const FoldingEnergy<Dim>> folding_;
};

extern template class Unfolding<2>;
extern template class Unfolding<3>;

}  // namespace crease
