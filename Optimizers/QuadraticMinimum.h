#pragma once

#include <Eigen/SparseCore>

#include "Optimizers/NullSpace.h"

namespace crease {

/// argmin 1/2 x^T A x - b^T x over all x = N y + x0, by one sparse Cholesky factorisation: the smoothest
/// deformation through landmarks, a least-squares fit that keeps them, the transfer between meshes.
///
/// @param A  lower triangle, compressed; either of full_size() = k m, or scalar, m x m: then the same A acts on
///           each of the k columns and is factored once for all.
/// @param b  full_size() numbers, stacked like x
/// @throws InvalidInput when sizes differ, SolverError when N^T A N is not positive definite.
Eigen::VectorXd minimize_quadratic(const Eigen::SparseMatrix<double>& A,
                                   const Eigen::Ref<const Eigen::VectorXd>& b,
                                   const NullSpace& null_space);

}  // namespace crease
