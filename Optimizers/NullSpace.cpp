#include "Optimizers/NullSpace.h"

#include <utility>

#include "Core/Error.h"
#include "Optimizers/EliminationNullSpace.h"
#include "Optimizers/QrNullSpace.h"
#include "Optimizers/SvdNullSpace.h"

namespace crease {
namespace {

void check_size(Eigen::Index given, Eigen::Index expected) {
  if (given == expected) return;
  throw InvalidInput(message("null space: expected a vector of ", expected, " numbers, got ", given,
                             "; stack the rows of an m x k matrix."));
}

void check_matrix(const Eigen::SparseMatrix<double>& H, Eigen::Index size) {
  if (H.rows() == size && H.cols() == size && H.isCompressed()) return;
  throw InvalidInput(message("null space: expected a compressed matrix of size ", size, " x ", size,
                             " to reduce, got ", H.rows(), " x ", H.cols(),
                             H.isCompressed() ? "" : ", not compressed", "."));
}

}  // namespace

NullSpace::NullSpace(LinearConstraints constraints, Eigen::Index m)
    : constraints_(std::move(constraints)) {
  check_constraints(constraints_, m);
  constraints_.C.makeCompressed();
  offset_ = RowMatrix::Zero(num_rows(), num_columns());
}

void NullSpace::set_rows(std::vector<int> independent, std::span<const int> dependent) {
  independent_rows_ = std::move(independent);
  dependent_rows_ = express_dependent_rows(constraints_, independent_rows_, dependent);
}

Eigen::VectorXd NullSpace::apply(const Eigen::Ref<const Eigen::VectorXd>& y) const {
  check_size(y.size(), reduced_size());
  return multiply(y);
}

Eigen::VectorXd NullSpace::apply_transpose(const Eigen::Ref<const Eigen::VectorXd>& g) const {
  check_size(g.size(), full_size());
  return multiply_transpose(g);
}

Eigen::VectorXd NullSpace::solve_gram(const Eigen::Ref<const Eigen::VectorXd>& g) const {
  check_size(g.size(), reduced_size());
  return divide_by_gram(g);
}

Eigen::VectorXd NullSpace::expand(const Eigen::Ref<const Eigen::VectorXd>& y) const {
  Eigen::VectorXd phi = apply(y);
  phi += Eigen::Map<const Eigen::VectorXd>(offset_.data(), offset_.size());
  return phi;
}

Eigen::VectorXd NullSpace::coordinates(const Eigen::Ref<const Eigen::VectorXd>& phi) const {
  check_size(phi.size(), full_size());
  return project(phi - Eigen::Map<const Eigen::VectorXd>(offset_.data(), offset_.size()));
}

void NullSpace::reduce_hessian(const Eigen::SparseMatrix<double>& H,
                               Eigen::SparseMatrix<double>& reduced) const {
  check_matrix(H, full_size());
  reduce(H, num_columns(), reduced);
}

void NullSpace::reduce_scalar(const Eigen::SparseMatrix<double>& K,
                              Eigen::SparseMatrix<double>& reduced) const {
  check_matrix(K, num_rows());
  reduce(K, 1, reduced);
}

std::unique_ptr<NullSpace> make_null_space(NullSpaceKind kind, LinearConstraints constraints,
                                           Eigen::Index m) {
  switch (kind) {
    case NullSpaceKind::kQr:
      return std::make_unique<QrNullSpace>(std::move(constraints), m);
    case NullSpaceKind::kSvd:
      return std::make_unique<SvdNullSpace>(std::move(constraints), m);
    default:
      return std::make_unique<EliminationNullSpace>(std::move(constraints), m);
  }
}

DependentRowClasses classify_dependent_rows(const NullSpace& null_space, double tolerance) {
  DependentRowClasses classes;
  for (const DependentRow& row : null_space.dependent_rows()) {
    (row.residual.norm() <= tolerance ? classes.redundant : classes.contradictory).push_back(row);
  }
  return classes;
}

}  // namespace crease
