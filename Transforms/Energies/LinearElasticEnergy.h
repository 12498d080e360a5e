#pragma once

#include <Eigen/SparseCore>

#include "Transforms/Energies/ElasticMaterial.h"
#include "Transforms/Energies/Energy.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

/// Linear elasticity of a small displacement v = sum_i phi_i B_i:
///
///     E(v) = 1/2 a(v, v),   a(v, v) = int lambda (div v)^2 + 2 mu |eps|^2 dx,   eps = 1/2 (grad v + grad v^T),
///
/// with Lame's parameters by region: the nonlinear ElasticEnergy's second derivative at rest, assembled
/// once, exactly. Zero for shifts and infinitesimal rotations, so that constraints must hold the body.
///
/// The affine part of a transform has no strain here: v is measured from it.
/// Source: dissertation, (4.9).
template <int Dim>
class LinearElasticEnergy final : public Energy<Dim> {
 public:
  /// The material's law and mean dilatation do not matter.
  /// @throws InvalidInput as ElasticEnergy.
  LinearElasticEnergy(const SplineBasis<Dim>& basis, const ElasticMaterial& material);

  /// (Dim n)^2, lower triangle: block (i, k) is
  /// int lambda grad B_i grad B_k^T + mu grad B_k grad B_i^T + mu (grad B_i . grad B_k) I dx.
  const Eigen::SparseMatrix<double>& matrix() const { return matrix_; }
  double evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                  ControlPoints<Dim>* gradient, BlockHessian<Dim>* hessian) const override;
  bool couples_coordinates() const override { return true; }

 private:
  BlockHessian<Dim> blocks_;
  Eigen::SparseMatrix<double> matrix_;
};

extern template class LinearElasticEnergy<2>;
extern template class LinearElasticEnergy<3>;

}  // namespace crease
