#pragma once

#include <Eigen/SparseCholesky>

#include "Optimizers/HessianReduction.h"
#include "Optimizers/NullSpace.h"

namespace crease {

/// N by Gauss-Jordan elimination (GaussJordan.h): with pivot rows p and free rows f of Phi
///
///     N(f, :) = I,   N(p, :) = -R,   Phi0(p) = rhs,   Phi0(f) = 0,
///
/// so that Y is Phi at the free rows. N is sparse (1 to 2 entries per column) and differs from the
/// identity only where columns of C are, but it is not orthonormal. Without constraints every operation
/// is a copy.
class EliminationNullSpace final : public NullSpace {
 public:
  EliminationNullSpace(LinearConstraints constraints, Eigen::Index m);

  /// The rows f of Phi that are free, ascending.
  const std::vector<int>& free_rows() const { return free_rows_; }
  /// N, m x (m - rank).
  const Eigen::SparseMatrix<double, Eigen::RowMajor>& basis() const { return N_; }

 private:
  Eigen::VectorXd multiply(const Eigen::Ref<const Eigen::VectorXd>& y) const override;
  Eigen::VectorXd multiply_transpose(const Eigen::Ref<const Eigen::VectorXd>& g) const override;
  Eigen::VectorXd divide_by_gram(const Eigen::Ref<const Eigen::VectorXd>& g) const override;
  Eigen::VectorXd project(const Eigen::Ref<const Eigen::VectorXd>& step) const override;
  void reduce(const Eigen::SparseMatrix<double>& H, Eigen::Index k,
              Eigen::SparseMatrix<double>& reduced) const override;

  std::vector<int> free_rows_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> N_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> R_;  // rank x (m - rank), rows as Phi(p)
  // I + R R^T: (N^T N)^-1 = I - R^T (I + R R^T)^-1 R  (Woodbury).
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> gram_;
  mutable HessianReduction reduction_, scalar_reduction_;
};

}  // namespace crease
