#pragma once

#include <Eigen/SparseCore>

#include "Optimizers/NullSpace.h"
#include "Optimizers/SparseCholesky.h"

namespace crease {

/// argmin 1/2 x^T A x - b^T x over all x = N y + x0, for any number of b by one sparse Cholesky
/// factorisation: the smoothest deformation through landmarks, a least-squares fit that keeps them, the
/// transfer between meshes.
class QuadraticMinimizer {
 public:
  /// @param A  lower triangle, compressed; either of full_size() = k m, or scalar, m x m: then the same A
  ///           acts on each of the k columns and is factored once for all.
  /// @param null_space  must outlive this.
  /// @throws InvalidInput when sizes differ, SolverError when N^T A N is not positive definite.
  QuadraticMinimizer(const Eigen::SparseMatrix<double>& A, const NullSpace& null_space);

  /// @param b  full_size() numbers, stacked like x.
  Eigen::VectorXd minimum(const Eigen::Ref<const Eigen::VectorXd>& b) const;

 private:
  const NullSpace& null_space_;
  bool scalar_;
  Eigen::VectorXd pull_of_offset_;  // A x0
  SparseCholesky factor_;
};

/// The same for a single b.
Eigen::VectorXd minimize_quadratic(const Eigen::SparseMatrix<double>& A,
                                   const Eigen::Ref<const Eigen::VectorXd>& b,
                                   const NullSpace& null_space);

}  // namespace crease
