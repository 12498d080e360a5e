#include "Transforms/Energies/DirichletEnergy.h"

#include "Transforms/Energies/ScalarAssembly.h"

namespace crease {

template <int Dim>
DirichletEnergy<Dim>::DirichletEnergy(const SplineBasis<Dim>& basis, int quadrature_degree)
    : form_(assemble_scalar_matrix<Dim>(
          basis, quadrature_degree >= 0 ? quadrature_degree : basis.product_degree(2, 1), 1,
          [](const QuadratureElement<Dim>& element, Eigen::MatrixXd& factor) {
            const Eigen::VectorXd root = element.weights.cwiseSqrt();
            factor.resize(element.values.rows(), Dim * root.size());
            for (int a = 0; a < Dim; ++a) {
              factor.middleCols(a * root.size(), root.size()) =
                  element.gradients[a] * root.asDiagonal();
            }
          })) {}

template class DirichletEnergy<2>;
template class DirichletEnergy<3>;

}  // namespace crease
