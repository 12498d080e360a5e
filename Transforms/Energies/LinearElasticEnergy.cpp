#include "Transforms/Energies/LinearElasticEnergy.h"

#include "Core/Error.h"
#include "Transforms/Energies/ElasticEnergy.h"

namespace crease {

template <int Dim>
LinearElasticEnergy<Dim>::LinearElasticEnergy(const SplineBasis<Dim>& basis,
                                              const ElasticMaterial& material)
    : blocks_(basis.pattern()) {
  ElasticMaterial linear = material;
  linear.law = ElasticLaw::kStVenantKirchhoff;
  linear.mean_dilatation = false;
  ElasticOptions<Dim> options;
  options.tangent = ElasticTangent::kExact;
  options.quadrature_degree = basis.product_degree(2, 1);
  const ElasticEnergy<Dim> nonlinear(basis, linear, {}, options);
  nonlinear.evaluate(ControlPoints<Dim>::Zero(Dim, basis.num_control_points()), 1, nullptr,
                     &blocks_);
  matrix_ = blocks_.to_sparse();
}

template <int Dim>
double LinearElasticEnergy<Dim>::evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi,
                                          double scale, ControlPoints<Dim>* gradient,
                                          BlockHessian<Dim>* hessian) const {
  const int n = blocks_.pattern().size();
  if (phi.cols() != n) {
    throw InvalidInput(
        message("LinearElasticEnergy: ", phi.cols(), " control points given, ", n, " expected."));
  }
  const Eigen::VectorXd stacked = phi.reshaped();
  const Eigen::VectorXd force = matrix_.template selfadjointView<Eigen::Lower>() * stacked;
  if (gradient != nullptr) gradient->reshaped() += scale * force;
  if (hessian != nullptr) {
    if (hessian->pattern().num_entries() != blocks_.pattern().num_entries()) {
      throw InvalidInput("LinearElasticEnergy: the Hessian has the pattern of another basis.");
    }
    for (int slot = 0; slot < blocks_.pattern().num_entries(); ++slot) {
      hessian->block(slot) += scale * blocks_.block(slot);
    }
  }
  return 0.5 * stacked.dot(force);
}

template class LinearElasticEnergy<2>;
template class LinearElasticEnergy<3>;

}  // namespace crease
