#pragma once

#include "Transforms/Energies/Energy.h"
#include "Transforms/Energies/QuadraticForm.h"
#include "Transforms/Energies/WeightField.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

/// E_S = 1/2 int (1 - w)^2 sum_ab |u_,ab|^2 dx over all Dim^2 second derivatives: bending counts where
/// tissue is soft, not inside rigid bodies, and not in the bending gaps of creases.
///
/// It is quadratic: K_ik = int (1 - w)^2 sum_ab B_i,ab B_k,ab dx is integrated once, cell by cell (exactly
/// where w is constant in every cell). A basis that knows K in closed form (SplineBasis::bending_matrix)
/// gives it where no weights are asked for: then the integral is over all of space. The affine part of T does not bend. Unit: mm^2 in 2D, mm^3 in 3D, over mm^2.
///
/// Source: dissertation, (3.7).
template <int Dim>
class BendingEnergy final : public Energy<Dim> {
 public:
  /// @param weights  null: soft everywhere.
  /// @throws InvalidInput when the basis has degree 1 (no second derivatives: use the DirichletEnergy)
  /// or a weight lies outside [0, 1].
  explicit BendingEnergy(const SplineBasis<Dim>& basis, const WeightField<Dim>& weights = nullptr);

  /// K, n x n, the same for every coordinate.
  const Eigen::SparseMatrix<double>& matrix() const { return form_.matrix(); }
  /// w; null: soft everywhere.
  const WeightField<Dim>& rigid() const { return weights_; }
  double evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                  ControlPoints<Dim>* gradient, BlockHessian<Dim>* hessian) const override {
    return form_.evaluate(phi, scale, gradient, hessian);
  }
  void add_stiffness(double scale, const HessianPattern& pattern,
                     std::span<double> stiffness) const override {
    form_.add_stiffness(scale, pattern, stiffness);
  }

 private:
  WeightField<Dim> weights_;
  QuadraticForm<Dim> form_;
};

extern template class BendingEnergy<2>;
extern template class BendingEnergy<3>;

}  // namespace crease
