#pragma once

#include <optional>

#include "Optimizers/NullSpace.h"
#include "Optimizers/OrthonormalBasis.h"

namespace crease {

/// Orthonormal N from a sparse QR factorisation C^T P = Q [R; 0] (SuiteSparse's SPQR, rows of C scaled to
/// max 1, columns that occur only, dead columns below 1e-9): the last columns of Q, which is kept as
/// Householder vectors and applied, never formed. Phi0 is the smallest solution.
///
/// Source: T. A. Davis, "Algorithm 915, SuiteSparseQR", ACM TOMS 38(1), 2011.
class QrNullSpace final : public NullSpace {
 public:
  QrNullSpace(LinearConstraints constraints, Eigen::Index m);

 private:
  Eigen::VectorXd multiply(const Eigen::Ref<const Eigen::VectorXd>& y) const override;
  Eigen::VectorXd multiply_transpose(const Eigen::Ref<const Eigen::VectorXd>& g) const override;
  Eigen::VectorXd divide_by_gram(const Eigen::Ref<const Eigen::VectorXd>& g) const override;
  Eigen::VectorXd project(const Eigen::Ref<const Eigen::VectorXd>& step) const override;
  void reduce(const Eigen::SparseMatrix<double>& H, Eigen::Index k,
              Eigen::SparseMatrix<double>& reduced) const override;

  std::optional<OrthonormalBasis> basis_;
};

}  // namespace crease
