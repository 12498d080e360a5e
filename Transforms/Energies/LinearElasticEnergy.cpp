#include "Transforms/Energies/LinearElasticEnergy.h"

#include <cmath>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Transforms/Energies/ScalarAssembly.h"

namespace crease {
namespace {

/// J with J J^T = the element's part of a: row Dim i + a, and per point the columns
///
///     sqrt(w (lambda + 2 mu / Dim)) div,    sqrt(2 mu w) dev eps_st (s = t),    2 sqrt(mu w) eps_st (s < t),
///
/// for lambda tr^2 + 2 mu |eps|^2 = (lambda + 2 mu / Dim) tr^2 + 2 mu |dev eps|^2, which are not negative
/// whatever the sign of lambda.
template <int Dim>
Eigen::MatrixXd strain_columns(const QuadratureElement<Dim>& element, const LameParameters& lame) {
  const auto k = std::ssize(element.control_points);
  const Eigen::Index q = element.weights.size();
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(Dim * k, (kNumSecondDerivatives<Dim> + 1) * q);
  for (Eigen::Index p = 0; p < q; ++p) {
    Matrix<Dim, Eigen::Dynamic> gradients(Dim, k);
    for (int a = 0; a < Dim; ++a) gradients.row(a) = element.gradients[a].col(p);
    const double bulk = std::sqrt(element.weights[p] * (lame.lambda + 2 * lame.mu / Dim));
    const double shear = std::sqrt(2 * lame.mu * element.weights[p]);
    const auto strain = [&](Eigen::Index column) {
      return Eigen::Map<ControlPoints<Dim>>(columns.col(column).data(), Dim, k);
    };
    strain(p) = bulk * gradients;
    for (int s = 0, pair = 1; s < Dim; ++s) {
      for (int t = s; t < Dim; ++t, ++pair) {
        auto column = strain(pair * q + p);
        if (s == t) column = -shear / Dim * gradients;
        const double half = s == t ? 0.5 : std::sqrt(0.5);
        column.row(s) += half * shear * gradients.row(t);
        column.row(t) += half * shear * gradients.row(s);
      }
    }
  }
  return columns;
}

/// A patch's part of the matrix, lower triangle.
template <int Dim>
Eigen::MatrixXd patch_matrix(const std::vector<QuadratureElement<Dim>>& elements,
                             const PatchRange& patch, const LameParameters& lame) {
  const auto m = Dim * std::ssize(patch.control_points);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(m, m);
  for (std::size_t e = patch.begin; e < patch.end; ++e) {
    const Eigen::MatrixXd columns = strain_columns(elements[e], lame);
    Eigen::MatrixXd square = Eigen::MatrixXd::Zero(columns.rows(), columns.rows());
    square.selfadjointView<Eigen::Lower>().rankUpdate(columns);
    // Positions ascend, so the lower triangle stays the lower one.
    const auto at = patch.positions(elements[e].control_points);
    for (std::size_t k = 0; k < at.size(); ++k) {
      for (std::size_t i = k; i < at.size(); ++i) {
        sum.block<Dim, Dim>(Dim * at[i], Dim * at[k]) += square.block<Dim, Dim>(Dim * i, Dim * k);
      }
    }
  }
  return sum;
}

template <int Dim>
void add_patch(const PatchRange& patch, const Eigen::MatrixXd& sum, BlockHessian<Dim>& blocks) {
  const auto& numbers = patch.control_points;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      // Functions of one patch that share no cell do not couple.
      const Matrix<Dim> block = sum.block<Dim, Dim>(Dim * i, Dim * k);
      if (!block.isZero(0)) blocks.add(numbers[i], numbers[k], block);
    }
    const Matrix<Dim> lower = sum.block<Dim, Dim>(Dim * i, Dim * i);
    blocks.add(numbers[i], numbers[i], lower.template selfadjointView<Eigen::Lower>());
  }
}

}  // namespace

template <int Dim>
LinearElasticEnergy<Dim>::LinearElasticEnergy(const SplineBasis<Dim>& basis,
                                              const ElasticMaterial& material)
    : blocks_(basis.pattern()) {
  const PlaneState plane = Dim == 2 ? material.plane : PlaneState::kStrain;
  visit_quadrature<Dim>(basis, basis.product_degree(2, 1), 1, nullptr, [&](auto& elements) {
    const auto patches = group_by_patch(elements);
    std::vector<LameParameters> lame;
    for (const PatchRange& patch : patches) {
      lame.push_back(lame_parameters(material.of(elements[patch.begin].region), plane));
    }
    std::vector<Eigen::MatrixXd> sums(patches.size());
    parallel_for(std::ssize(patches), [&](std::int64_t p) {
      const auto n = static_cast<std::size_t>(p);
      sums[n] = patch_matrix<Dim>(elements, patches[n], lame[n]);
    });
    for (std::size_t p = 0; p < patches.size(); ++p) add_patch<Dim>(patches[p], sums[p], blocks_);
  });
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
