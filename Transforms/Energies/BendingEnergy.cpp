#include "Transforms/Energies/BendingEnergy.h"

#include "Transforms/Energies/ScalarAssembly.h"

namespace crease {
namespace {

/// Square roots of weight (1 - w)^2 at the element's points.
template <int Dim>
Eigen::VectorXd root_weights(const QuadratureElement<Dim>& element, const WeightField<Dim>& weights,
                             WeightRange& range) {
  Eigen::VectorXd root = element.weights.cwiseSqrt();
  if (!weights) return root;
  Eigen::VectorXd w(root.size());
  for (Eigen::Index q = 0; q < w.size(); ++q) w[q] = weights(element.points.col(q), element.region);
  range.add(w.minCoeff<Eigen::PropagateNaN>(), w.maxCoeff<Eigen::PropagateNaN>());
  return root.array() * (1 - w.array()).abs();
}

template <int Dim>
Eigen::SparseMatrix<double> bending_matrix(const SplineBasis<Dim>& basis,
                                           const WeightField<Dim>& weights) {
  if (basis.degree() < 2) {
    throw InvalidInput(
        "BendingEnergy: splines of degree 1 have no second derivatives and hence no bending "
        "energy; "
        "use the DirichletEnergy or a higher degree.");
  }
  if (!weights || weights.is_constant(-1, 0.0)) {  // such a basis has no regions
    if (const auto closed = basis.bending_matrix()) return closed->sparseView(1.0, 0.0);
  }
  WeightRange range;
  auto matrix = assemble_scalar_matrix<Dim>(
      basis, basis.product_degree(2, 2), 2,
      [&](const QuadratureElement<Dim>& element, Eigen::MatrixXd& factor) {
        if (element.in_band) return;
        const auto root = root_weights(element, weights, range);
        if (root.isZero(0)) return;
        const Eigen::Index k = std::ssize(element.control_points), q = root.size();
        factor.resize(k, kNumSecondDerivatives<Dim> * q);
        for (int a = 0, s = 0; a < Dim; ++a) {
          for (int b = a; b < Dim; ++b, ++s) {
            const double both = a == b ? 1.0 : std::sqrt(2.0);
            factor.middleCols(s * q, q) = element.hessians[s] * (both * root).asDiagonal();
          }
        }
      },
      [&](int region, int) { return !weights.is_constant(region, 1.0); });
  range.check("BendingEnergy");
  return matrix;
}

}  // namespace

template <int Dim>
BendingEnergy<Dim>::BendingEnergy(const SplineBasis<Dim>& basis, const WeightField<Dim>& weights)
    : weights_(weights), form_(bending_matrix<Dim>(basis, weights)) {}

template class BendingEnergy<2>;
template class BendingEnergy<3>;

}  // namespace crease
