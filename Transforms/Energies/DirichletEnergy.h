#pragma once

#include "Transforms/Energies/Energy.h"
#include "Transforms/Energies/QuadraticForm.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

/// E_D = 1/2 int |grad u|^2 dx: pulls a map towards a translation. It steadies starts that bending alone
/// leaves free, and stands in for bending where splines of degree 1 have none.
template <int Dim>
class DirichletEnergy final : public Energy<Dim> {
 public:
  /// @param quadrature_degree  negative: exact. A regulariser does not need to be: degree 1 costs a sixth.
  explicit DirichletEnergy(const SplineBasis<Dim>& basis, int quadrature_degree = -1);

  /// K_ik = int grad B_i . grad B_k dx, n x n, the same for every coordinate.
  const Eigen::SparseMatrix<double>& matrix() const { return form_.matrix(); }
  double evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                  ControlPoints<Dim>* gradient, BlockHessian<Dim>* hessian) const override {
    return form_.evaluate(phi, scale, gradient, hessian);
  }
  void add_stiffness(double scale, const HessianPattern& pattern,
                     std::span<double> stiffness) const override {
    form_.add_stiffness(scale, pattern, stiffness);
  }

 private:
  QuadraticForm<Dim> form_;
};

extern template class DirichletEnergy<2>;
extern template class DirichletEnergy<3>;

}  // namespace crease
