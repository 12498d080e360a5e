#pragma once

#include <Eigen/SparseCore>
#include <functional>

#include "Transforms/Splines/SplineBasis.h"

namespace crease {

/// Calls visit with the basis' quadrature elements, whole patches at a time and in their order, few
/// enough that memory stays small however large the domain is.
template <int Dim>
void visit_quadrature(const SplineBasis<Dim>& basis, int polynomial_degree, int derivatives,
                      const std::function<bool(int region, int patch)>& wanted,
                      const std::function<void(std::vector<QuadratureElement<Dim>>&)>& visit);

/// Elements that belong to one patch, and the control points of any of them.
struct PatchRange {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::vector<int> control_points;  ///< ascending
  /// Positions of an element's control points among the patch's.
  std::vector<int> positions(const std::vector<int>& of_element) const;
};
template <int Dim>
std::vector<PatchRange> group_by_patch(const std::vector<QuadratureElement<Dim>>& elements);

/// Gives for an element the matrix A (its k control points x any number of columns) whose A A^T is the
/// element's part of the sum; no columns for elements that add nothing. Called from several threads.
template <int Dim>
using ElementFactor =
    std::function<void(const QuadratureElement<Dim>& element, Eigen::MatrixXd& factor)>;

/// K = sum over elements of A A^T: n x n, symmetric, both triangles, with the sparsity of the basis'
/// couplings. Parallel, the same bits on any number of threads.
/// @param wanted  patches that may add something; null: all.
template <int Dim>
Eigen::SparseMatrix<double> assemble_scalar_matrix(
    const SplineBasis<Dim>& basis, int polynomial_degree, int derivatives,
    const ElementFactor<Dim>& factor,
    const std::function<bool(int region, int patch)>& wanted = nullptr);

/// n x n mass matrix M_ik = integral of B_i B_k over the domain, exact.
template <int Dim>
Eigen::SparseMatrix<double> mass_matrix(const SplineBasis<Dim>& basis);

}  // namespace crease
