#include "Optimizers/QuadraticMinimum.h"

#include "Core/Error.h"
#include "Optimizers/SparseCholesky.h"

namespace crease {
namespace {

Eigen::Map<const RowMatrix> as_rows(const Eigen::VectorXd& x, Eigen::Index k) {
  return {x.data(), x.size() / k, k};
}

Eigen::VectorXd stack(const RowMatrix& rows) {
  return Eigen::Map<const Eigen::VectorXd>(rows.data(), rows.size());
}

}  // namespace

Eigen::VectorXd minimize_quadratic(const Eigen::SparseMatrix<double>& A,
                                   const Eigen::Ref<const Eigen::VectorXd>& b,
                                   const NullSpace& null_space) {
  const Eigen::Index k = null_space.num_columns();
  const bool scalar = A.rows() == null_space.num_rows();
  if (b.size() != null_space.full_size() || (!scalar && A.rows() != null_space.full_size())) {
    throw InvalidInput(message("minimum of a quadratic function: the null space has ",
                               null_space.num_rows(), " x ", k, " unknowns, the matrix ", A.rows(),
                               " rows and the linear term ", b.size(), " numbers."));
  }
  Eigen::SparseMatrix<double> reduced;
  scalar ? null_space.reduce_scalar(A, reduced) : null_space.reduce_hessian(A, reduced);
  const Eigen::VectorXd offset = stack(null_space.offset());
  const Eigen::VectorXd gradient =
      scalar ? stack(A.selfadjointView<Eigen::Lower>() * as_rows(offset, k))
             : Eigen::VectorXd(A.selfadjointView<Eigen::Lower>() * offset);
  const Eigen::VectorXd rhs = null_space.apply_transpose(b - gradient);
  if (rhs.size() == 0) return offset;

  SparseCholesky cholesky;
  if (!cholesky.factor(reduced)) {
    throw SolverError(
        message("minimum of a quadratic function: the matrix is not positive definite on the ",
                reduced.rows(), " free unknowns; add a term that sees every control point."));
  }
  if (!scalar) return null_space.expand(cholesky.solve(rhs));
  return null_space.expand(stack(cholesky.solve_columns(as_rows(rhs, k))));
}

}  // namespace crease
