#pragma once

#include <span>

#include "Transforms/AffineMap.h"
#include "Transforms/Energies/Energy.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

/// Landmarks with an uncertainty s_j (mm): E_L = 1/2 sum_j s_j^-2 |T(p_j) - q_j|^2.
template <int Dim>
class LandmarkEnergy final : public Energy<Dim> {
 public:
  /// @param fixed, moving  pairs p_j, q_j in mm.
  /// @param sigma_mm       s_j > 0, one per pair.
  /// @throws InvalidInput when the numbers differ, a value is not finite, a sigma not positive, or a
  /// fixed landmark lies outside the basis' domain (the message names its distance).
  LandmarkEnergy(const SplineBasis<Dim>& basis, const AffineMap<Dim>& affine,
                 std::span<const Point<Dim>> fixed, std::span<const Point<Dim>> moving,
                 std::span<const double> sigma_mm);

  double evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                  ControlPoints<Dim>* gradient, BlockHessian<Dim>* hessian) const override;
  void add_stiffness(double scale, const HessianPattern& pattern,
                     std::span<double> stiffness) const override;
  bool add_pull(const Eigen::Ref<const ControlPoints<Dim>>& phi0, double scale,
                ControlPoints<Dim>& pull) const override;

 private:
  struct Landmark {
    BasisValues<Dim> basis;
    Vector<Dim> wanted;  // q_j - A(p_j)
    double weight;       // s_j^-2
  };
  std::vector<Landmark> landmarks_;
};

extern template class LandmarkEnergy<2>;
extern template class LandmarkEnergy<3>;

}  // namespace crease
