#include "Optimizers/Substitution.h"

#include <algorithm>
#include <vector>

#include "Core/Error.h"

namespace crease {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

// Added to the diagonal, relative to its mean, where P is only semi-definite.
constexpr double kLeastShift = 1e-8;
constexpr double kLargestShift = 1.0;
constexpr double kShiftFactor = 100.0;

Sparse identity(Eigen::Index m) {
  Sparse matrix(m, m);
  matrix.setIdentity();
  return matrix;
}

// P (x) I_copies.
Sparse repeated(const Sparse& P, Eigen::Index copies) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(copies * P.nonZeros()));
  for (int j = 0; j < P.outerSize(); ++j) {
    for (Sparse::InnerIterator entry(P, j); entry; ++entry) {
      for (Eigen::Index a = 0; a < copies; ++a) {
        entries.emplace_back(static_cast<int>(copies * entry.row() + a),
                             static_cast<int>(copies * j + a), entry.value());
      }
    }
  }
  Sparse matrix(copies * P.rows(), copies * P.cols());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Eigen::VectorXd stacked(const RowMatrix& rows) {
  return Eigen::Map<const Eigen::VectorXd>(rows.data(), rows.size());
}

}  // namespace

Substitution::Substitution(ObjectiveFunction& function, const Eigen::Ref<const Eigen::VectorXd>& x,
                           const NullSpace& null_space, bool preconditioned) {
  Sparse P;
  preconditioned_ = preconditioned && function.preconditioner(x, P);
  if (null_space.reduced_size() == 0) return;
  factor(null_space, preconditioned_ ? P : identity(null_space.num_rows()));
}

void Substitution::factor(const NullSpace& null_space, const Sparse& P) {
  const Eigen::Index m = null_space.num_rows();
  Sparse reduced;
  if (P.rows() == m) {
    null_space.reduce_scalar(P, reduced);
  } else if (P.rows() == null_space.full_size()) {
    null_space.reduce_hessian(P, reduced);
  } else if (P.rows() > 0 && m % P.rows() == 0) {  // constraints couple the coordinates
    null_space.reduce_scalar(repeated(P, m / P.rows()), reduced);
  } else {
    throw InvalidInput(message("preconditioner: a matrix of ", P.rows(), " rows does not go with ",
                               null_space.full_size(), " unknowns."));
  }
  columns_ = null_space.reduced_size() / reduced.rows();
  const double mean = reduced.diagonal().mean();
  for (double shift = kLeastShift; !factor_.factor(reduced); shift *= kShiftFactor) {
    if (!(shift <= kLargestShift)) {
      throw SolverError("preconditioner: the matrix is not positive semi-definite, or not finite.");
    }
    for (int j = 0; j < reduced.outerSize(); ++j) reduced.coeffRef(j, j) += shift * mean;
  }
}

Eigen::VectorXd Substitution::step(const Eigen::Ref<const Eigen::VectorXd>& z) const {
  const Eigen::Map<const RowMatrix> rows(z.data(), z.size() / columns_, columns_);
  return stacked(factor_.solve_root(rows));
}

Eigen::VectorXd Substitution::gradient(const Eigen::Ref<const Eigen::VectorXd>& g) const {
  const Eigen::Map<const RowMatrix> rows(g.data(), g.size() / columns_, columns_);
  return stacked(factor_.solve_root_transpose(rows));
}

}  // namespace crease
