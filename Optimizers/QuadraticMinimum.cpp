#include "Optimizers/QuadraticMinimum.h"

#include "Core/Error.h"

namespace crease {
namespace {

Eigen::Map<const RowMatrix> as_rows(const Eigen::VectorXd& x, Eigen::Index k) {
  return {x.data(), x.size() / k, k};
}

Eigen::VectorXd stack(const RowMatrix& rows) {
  return Eigen::Map<const Eigen::VectorXd>(rows.data(), rows.size());
}

}  // namespace

QuadraticMinimizer::QuadraticMinimizer(const Eigen::SparseMatrix<double>& A,
                                       const NullSpace& null_space)
    : null_space_(null_space), scalar_(A.rows() == null_space.num_rows()) {
  const Eigen::Index k = null_space.num_columns();
  if (!scalar_ && A.rows() != null_space.full_size()) {
    throw InvalidInput(message("minimum of a quadratic function: the null space has ",
                               null_space.num_rows(), " x ", k, " unknowns, the matrix ", A.rows(),
                               " rows."));
  }
  const Eigen::VectorXd offset = stack(null_space.offset());
  pull_of_offset_ = scalar_ ? stack(A.selfadjointView<Eigen::Lower>() * as_rows(offset, k))
                            : Eigen::VectorXd(A.selfadjointView<Eigen::Lower>() * offset);
  if (null_space.reduced_size() == 0) return;
  Eigen::SparseMatrix<double> reduced;
  scalar_ ? null_space.reduce_scalar(A, reduced) : null_space.reduce_hessian(A, reduced);
  if (!factor_.factor(reduced)) {
    throw SolverError(
        message("minimum of a quadratic function: the matrix is not positive definite on the ",
                reduced.rows(), " free unknowns; add a term that sees every control point."));
  }
}

Eigen::VectorXd QuadraticMinimizer::minimum(const Eigen::Ref<const Eigen::VectorXd>& b) const {
  if (b.size() != null_space_.full_size()) {
    throw InvalidInput(message("minimum of a quadratic function: a linear term of ", b.size(),
                               " numbers for ", null_space_.full_size(), " unknowns."));
  }
  const Eigen::VectorXd rhs = null_space_.apply_transpose(b - pull_of_offset_);
  if (rhs.size() == 0) return stack(null_space_.offset());
  if (!scalar_) return null_space_.expand(factor_.solve(rhs));
  return null_space_.expand(stack(factor_.solve_columns(as_rows(rhs, null_space_.num_columns()))));
}

Eigen::VectorXd minimize_quadratic(const Eigen::SparseMatrix<double>& A,
                                   const Eigen::Ref<const Eigen::VectorXd>& b,
                                   const NullSpace& null_space) {
  return QuadraticMinimizer(A, null_space).minimum(b);
}

}  // namespace crease
