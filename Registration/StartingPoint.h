#pragma once

#include <memory>
#include <vector>

#include "Optimizers/NullSpace.h"
#include "Registration/ImageTerm.h"
#include "Registration/RegistrationObjective.h"
#include "Transforms/SplineProjection.h"

namespace crease {

/// Control points from which a registration starts: the minimum of its energies' quadratic stand-ins
/// (Energy::add_stiffness) within the exact constraints, with or without a field of displacements to
/// follow. One scalar factor serves all coordinates; what turns with the solution (rigid bodies) is
/// renewed a few times.
template <int Dim>
class StartingPoint {
 public:
  /// All must outlive this.
  StartingPoint(std::shared_ptr<const HessianPattern> pattern, const NullSpace& null_space,
                const std::vector<WeightedEnergy<Dim>>& energies);

  /// The smoothest displacement that meets the constraints.
  /// Source: registration in the null space, the start after elimination.
  Eigen::VectorXd smoothest() const;
  /// Weighted least squares to the target of the term (TargetDisplacement), smoothed by the energies.
  /// @param near  where bodies are first looked for.
  Eigen::VectorXd fitted_to(ImageTerm<Dim>& target, const Eigen::VectorXd& near) const;
  /// The spline of `basis` that is nearest to a displacement, in the mean square over the domain.
  Eigen::VectorXd nearest_to(const SplineBasis<Dim>& basis,
                             const DisplacementFunction<Dim>& displacement) const;

 private:
  Eigen::VectorXd minimum(std::vector<double> stiffness, const ControlPoints<Dim>& pull,
                          Eigen::VectorXd phi) const;

  std::shared_ptr<const HessianPattern> pattern_;
  const NullSpace& null_space_;
  const std::vector<WeightedEnergy<Dim>>& energies_;
};

extern template class StartingPoint<2>;
extern template class StartingPoint<3>;

}  // namespace crease
