#pragma once

#include <optional>

#include "Optimizers/NullSpace.h"
#include "Optimizers/OrthonormalBasis.h"

namespace crease {

/// Orthonormal N from the dense singular value decomposition of C (rows scaled to max 1, columns that
/// occur only): the right singular vectors of the values below 1e-9 of the largest. O(t^2 r) for t
/// control points in r constraints: for small r, and as a reference.
class SvdNullSpace final : public NullSpace {
 public:
  SvdNullSpace(LinearConstraints constraints, Eigen::Index m);

  /// Singular values of C with rows scaled to max |c| = 1, descending.
  const Eigen::VectorXd& singular_values() const { return singular_values_; }

 private:
  Eigen::VectorXd multiply(const Eigen::Ref<const Eigen::VectorXd>& y) const override;
  Eigen::VectorXd multiply_transpose(const Eigen::Ref<const Eigen::VectorXd>& g) const override;
  Eigen::VectorXd divide_by_gram(const Eigen::Ref<const Eigen::VectorXd>& g) const override;
  Eigen::VectorXd project(const Eigen::Ref<const Eigen::VectorXd>& step) const override;
  void reduce(const Eigen::SparseMatrix<double>& H, Eigen::Index k,
              Eigen::SparseMatrix<double>& reduced) const override;

  std::optional<OrthonormalBasis> basis_;
  Eigen::VectorXd singular_values_;
};

}  // namespace crease
