#include "Optimizers/EliminationNullSpace.h"

#include <algorithm>
#include <utility>

#include "Optimizers/GaussJordan.h"

namespace crease {
namespace {

using RowSparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Triplets = std::vector<Eigen::Triplet<double>>;

RowSparse sparse(Eigen::Index rows, Eigen::Index cols, const Triplets& entries) {
  RowSparse matrix(rows, cols);
  matrix.setFromTriplets(entries.begin(), entries.end());
  matrix.makeCompressed();
  return matrix;
}

Eigen::Map<const RowMatrix> as_rows(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::Index k) {
  return {x.data(), x.size() / k, k};
}

}  // namespace

EliminationNullSpace::EliminationNullSpace(LinearConstraints constraints, Eigen::Index m)
    : NullSpace(std::move(constraints), m) {
  GaussJordanForm form = gauss_jordan(this->constraints());
  std::vector<int> column_of(static_cast<std::size_t>(m), 0);  // of Y, for free rows
  for (int p : form.pivot_columns) column_of[static_cast<std::size_t>(p)] = -1;
  Triplets basis;
  Triplets coefficients;
  for (int i = 0; i < static_cast<int>(m); ++i) {
    int& column = column_of[static_cast<std::size_t>(i)];
    if (column < 0) continue;
    column = static_cast<int>(free_rows_.size());
    basis.emplace_back(i, column, 1.0);
    free_rows_.push_back(i);
  }
  for (std::size_t n = 0; n < form.R.size(); ++n) {
    const int p = form.pivot_columns[n];
    for (const auto& [j, value] : form.R[n]) {
      const int column = column_of[static_cast<std::size_t>(j)];
      basis.emplace_back(p, column, -value);
      coefficients.emplace_back(static_cast<int>(n), column, value);
    }
    offset_.row(p) = form.rhs.row(static_cast<Eigen::Index>(n));
  }
  const auto rank = static_cast<Eigen::Index>(form.R.size());
  N_ = sparse(m, m - rank, basis);
  R_ = sparse(rank, m - rank, coefficients);
  if (rank > 0) {
    Eigen::SparseMatrix<double> identity(rank, rank);
    identity.setIdentity();
    gram_.compute(Eigen::SparseMatrix<double>(R_ * R_.transpose()) + identity);
  }
  std::sort(form.pivot_rows.begin(), form.pivot_rows.end());
  set_rows(std::move(form.pivot_rows), form.dependent_rows);
}

Eigen::VectorXd EliminationNullSpace::multiply(const Eigen::Ref<const Eigen::VectorXd>& y) const {
  if (rank() == 0) return y;
  Eigen::VectorXd phi(full_size());
  Eigen::Map<RowMatrix>(phi.data(), num_rows(), num_columns()).noalias() =
      N_ * as_rows(y, num_columns());
  return phi;
}

Eigen::VectorXd EliminationNullSpace::multiply_transpose(
    const Eigen::Ref<const Eigen::VectorXd>& g) const {
  if (rank() == 0) return g;
  Eigen::VectorXd reduced(reduced_size());
  Eigen::Map<RowMatrix>(reduced.data(), num_free(), num_columns()).noalias() =
      N_.transpose() * as_rows(g, num_columns());
  return reduced;
}

Eigen::VectorXd EliminationNullSpace::divide_by_gram(
    const Eigen::Ref<const Eigen::VectorXd>& g) const {
  Eigen::VectorXd result = g;
  if (rank() == 0) return result;
  const Eigen::MatrixXd inner = R_ * as_rows(g, num_columns());
  const RowMatrix solved = gram_.solve(inner);
  Eigen::Map<RowMatrix>(result.data(), num_free(), num_columns()) -= R_.transpose() * solved;
  return result;
}

Eigen::VectorXd EliminationNullSpace::project(const Eigen::Ref<const Eigen::VectorXd>& step) const {
  const Eigen::Index k = num_columns();
  Eigen::VectorXd y(reduced_size());
  for (std::size_t f = 0; f < free_rows_.size(); ++f) {
    y.segment(k * static_cast<Eigen::Index>(f), k) = step.segment(k * free_rows_[f], k);
  }
  return y;
}

void EliminationNullSpace::reduce(const Eigen::SparseMatrix<double>& H, Eigen::Index k,
                                  Eigen::SparseMatrix<double>& reduced) const {
  (k == 1 ? scalar_reduction_ : reduction_).reduce(N_, k, H, reduced);
}

}  // namespace crease
