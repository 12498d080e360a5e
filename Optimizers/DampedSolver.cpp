#include "Optimizers/DampedSolver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "Optimizers/LinearConstraints.h"

namespace crease {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr double kDiagonalFloor =
    1e-6;                           // of the mean diagonal: damps directions that H does not see
constexpr int kScalarPatience = 3;  // a scalar factor is worth that many times more iterations

// The lower triangle's symmetric product, in fixed order.
Eigen::VectorXd symmetric_product(const Sparse& lower, const Eigen::VectorXd& x) {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(x.size());
  const int* start = lower.outerIndexPtr();
  const int* row = lower.innerIndexPtr();
  const double* value = lower.valuePtr();
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const double xj = x[j];
    double sum = value[start[j]] * xj;  // the diagonal comes first
    for (int s = start[j] + 1; s < start[j + 1]; ++s) {
      y[row[s]] += value[s] * xj;
      sum += value[s] * x[row[s]];
    }
    y[j] += sum;
  }
  return y;
}

}  // namespace

void DampedSolver::hessian_changed() {
  diagonal_.resize(A_.cols());
  for (Eigen::Index j = 0; j < A_.cols(); ++j) diagonal_[j] = A_.valuePtr()[A_.outerIndexPtr()[j]];
}

void DampedSolver::set_damping(double damping) {
  const double floor = diagonal_.size() == 0 ? 0.0 : kDiagonalFloor * diagonal_.cwiseAbs().mean();
  for (Eigen::Index j = 0; j < A_.cols(); ++j) {
    A_.valuePtr()[A_.outerIndexPtr()[j]] =
        diagonal_[j] + damping * std::max(std::abs(diagonal_[j]), floor);
  }
}

DampedSolver::Result DampedSolver::solve(const Eigen::Ref<const Eigen::VectorXd>& b,
                                         double damping) {
  set_damping(damping);
  if (A_.cols() == 0) return Eigen::VectorXd(0);
  switch (options_.kind) {
    case LinearSolver::kPreconditionedCg:
      return solve_with_kept_factor(b);
    case LinearSolver::kScalarPreconditionedCg:
      return solve_with_scalar_factor(b);
    default:
      return solve_direct(b);
  }
}

DampedSolver::Result DampedSolver::solve_direct(const Eigen::Ref<const Eigen::VectorXd>& b) {
  ++factorizations_;
  if (!factor_.factor(A_)) return std::nullopt;
  return factor_.solve(b);
}

DampedSolver::Result DampedSolver::solve_with_kept_factor(
    const Eigen::Ref<const Eigen::VectorXd>& b) {
  if (factor_.has_factor() && factor_.size() == A_.cols()) {
    const auto apply_factor = [this](const Eigen::VectorXd& r) { return factor_.solve(r); };
    if (auto x = conjugate_gradients(b, options_.max_cg_iterations, apply_factor)) return x;
  }
  return solve_direct(b);
}

// Couplings between components, which the scalar factor does not see, may be too strong for it; then the
// factor of the whole matrix takes its place for good.
DampedSolver::Result DampedSolver::solve_with_scalar_factor(
    const Eigen::Ref<const Eigen::VectorXd>& b) {
  if (factor_.has_factor()) return solve_with_kept_factor(b);
  const auto apply_factor = [this](const Eigen::VectorXd& r) -> Eigen::VectorXd {
    const Eigen::Map<const RowMatrix> rows(r.data(), r.size() / k_, k_);
    const Eigen::MatrixXd columns = rows;
    const RowMatrix solved = scalar_factor_.solve_columns(columns);
    return Eigen::Map<const Eigen::VectorXd>(solved.data(), solved.size());
  };
  const int patience = options_.max_cg_iterations * kScalarPatience;
  const bool kept = scalar_factor_.has_factor() && scalar_factor_.size() * k_ == A_.cols();
  if (kept) {
    if (auto x = conjugate_gradients(b, patience, apply_factor)) return x;
  }
  if (!factor_scalar()) return std::nullopt;
  if (auto x = conjugate_gradients(b, patience, apply_factor)) return x;
  return solve_direct(b);
}

DampedSolver::Result DampedSolver::conjugate_gradients(const Eigen::Ref<const Eigen::VectorXd>& b,
                                                       int max_iterations,
                                                       const Preconditioner& preconditioner) {
  auto result = linear_conjugate_gradient(
      [this](const Eigen::VectorXd& p) { return symmetric_product(A_, p); }, preconditioner, b,
      {.tolerance = options_.cg_tolerance, .max_iterations = max_iterations});
  cg_iterations_ += result.iterations;
  if (!result.converged) return std::nullopt;
  return std::move(result.x);
}

bool DampedSolver::factor_scalar() {
  if (static_cast<Eigen::Index>(scalar_target_.size()) != A_.nonZeros()) analyse_scalar();
  std::fill(scalar_.valuePtr(), scalar_.valuePtr() + scalar_.nonZeros(), 0.0);
  const double share = 1.0 / static_cast<double>(k_);
  for (std::size_t s = 0; s < scalar_target_.size(); ++s) {
    if (scalar_target_[s] >= 0) scalar_.valuePtr()[scalar_target_[s]] += share * A_.valuePtr()[s];
  }
  ++factorizations_;
  return scalar_factor_.factor(scalar_);
}

void DampedSolver::analyse_scalar() {
  const auto block = static_cast<int>(k_);
  std::vector<Eigen::Triplet<double>> entries;
  for (int j = 0; j < A_.outerSize(); ++j) {
    for (Sparse::InnerIterator entry(A_, j); entry; ++entry) {
      if (entry.row() % block == j % block) {
        entries.emplace_back(static_cast<int>(entry.row()) / block, j / block, 0.0);
      }
    }
  }
  scalar_.resize(A_.rows() / k_, A_.cols() / k_);
  scalar_.setFromTriplets(entries.begin(), entries.end());
  scalar_target_.clear();
  for (int j = 0; j < A_.outerSize(); ++j) {
    const int* first = scalar_.innerIndexPtr() + scalar_.outerIndexPtr()[j / block];
    const int* last = scalar_.innerIndexPtr() + scalar_.outerIndexPtr()[j / block + 1];
    for (Sparse::InnerIterator entry(A_, j); entry; ++entry) {
      const auto row = static_cast<int>(entry.row());
      const bool averaged = row % block == j % block;
      scalar_target_.push_back(averaged
                                   ? static_cast<int>(std::lower_bound(first, last, row / block) -
                                                      scalar_.innerIndexPtr())
                                   : -1);
    }
  }
}

}  // namespace crease
