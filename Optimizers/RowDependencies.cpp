#include "Optimizers/RowDependencies.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseQR>
#include <algorithm>
#include <cmath>
#include <optional>

#include "Core/Error.h"

namespace crease {
namespace {

using ColumnSparse = Eigen::SparseMatrix<double>;
using Factor = Eigen::SparseQR<ColumnSparse, Eigen::COLAMDOrdering<int>>;

// Weights below this share of the row are rounding.
constexpr double kNegligibleWeight = 1e-8;

double scale_of(const LinearConstraints& constraints, int row) {
  double scale = 0.0;
  for (decltype(constraints.C)::InnerIterator entry(constraints.C, row); entry; ++entry) {
    scale = std::max(scale, std::abs(entry.value()));
  }
  return scale;
}

// The factorisation C_ind^T S^-1 P = Q R of the independent rows, S = their largest entries.
class IndependentRows {
 public:
  IndependentRows(const LinearConstraints& constraints, std::span<const int> rows)
      : scales_(static_cast<Eigen::Index>(rows.size())) {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double scale = scale_of(constraints, rows[i]);
      scales_[static_cast<Eigen::Index>(i)] = scale;
      for (decltype(constraints.C)::InnerIterator entry(constraints.C, rows[i]); entry; ++entry) {
        entries.emplace_back(entry.col(), i, entry.value() / scale);
      }
    }
    ColumnSparse transposed(constraints.C.cols(), scales_.size());
    transposed.setFromTriplets(entries.begin(), entries.end());
    transposed.makeCompressed();
    factor_.setPivotThreshold(0.0);  // their rank is known
    factor_.compute(transposed);
    if (factor_.info() != Eigen::Success || factor_.rank() != scales_.size()) {
      throw SolverError(message("linear constraints: the factorisation of ", scales_.size(),
                                " rows failed (", factor_.lastErrorMessage(), ", rank ",
                                factor_.rank(), "); remove rows that nearly repeat each other."));
    }
  }

  double scale(Eigen::Index i) const { return scales_[i]; }
  // w with c = C_ind^T w.
  Eigen::VectorXd weights(const Eigen::VectorXd& c) const {
    return (factor_.solve(c).array() / scales_.array()).matrix();
  }
  // The smallest Delta with C_ind Delta = rhs.
  Eigen::MatrixXd smallest_solution(const Eigen::MatrixXd& rhs) const {
    const Eigen::Index rank = scales_.size();
    const Eigen::MatrixXd permuted =
        factor_.colsPermutation().transpose() * (scales_.cwiseInverse().asDiagonal() * rhs);
    const ColumnSparse R = factor_.matrixR().topLeftCorner(rank, rank);
    Eigen::MatrixXd padded = Eigen::MatrixXd::Zero(factor_.rows(), rhs.cols());
    padded.topRows(rank) = R.transpose().triangularView<Eigen::Lower>().solve(permuted);
    return factor_.matrixQ() * padded;
  }

 private:
  Eigen::VectorXd scales_;
  Factor factor_;
};

}  // namespace

std::vector<DependentRow> express_dependent_rows(const LinearConstraints& constraints,
                                                 std::span<const int> independent,
                                                 std::span<const int> dependent) {
  std::vector<DependentRow> result;
  if (dependent.empty()) return result;
  std::optional<IndependentRows> rows;
  if (!independent.empty()) rows.emplace(constraints, independent);
  for (int j : dependent) {
    DependentRow found{.row = j, .depends_on = {}, .weights = {}, .residual = constraints.d.row(j)};
    const double scale = scale_of(constraints, j);
    Eigen::VectorXd w;
    if (scale > 0.0 && rows) w = rows->weights(constraints.C.row(j).transpose());
    for (Eigen::Index n = 0; n < w.size(); ++n) {
      const auto i = static_cast<std::size_t>(n);
      const double weight = w[n];
      if (std::abs(weight) * rows->scale(n) <= kNegligibleWeight * scale) continue;
      found.depends_on.push_back(independent[i]);
      found.weights.push_back(weight);
      found.residual -= weight * constraints.d.row(independent[i]).transpose();
    }
    result.push_back(std::move(found));
  }
  return result;
}

// With e = C_ind Phi and W the dependent rows' weights, |C Phi - d|^2 = |e - d_ind|^2 + |W e - d_dep|^2
// is least for e = d_ind + W^T (I + W W^T)^-1 rho.
RowMatrix least_squares_correction(const LinearConstraints& constraints,
                                   std::span<const int> independent,
                                   std::span<const DependentRow> dependent) {
  const Eigen::Index m = constraints.C.cols();
  const Eigen::Index k = constraints.d.cols();
  if (dependent.empty() || independent.empty()) return RowMatrix::Zero(m, k);
  const auto num_dependent = static_cast<Eigen::Index>(dependent.size());
  Eigen::MatrixXd W =
      Eigen::MatrixXd::Zero(num_dependent, static_cast<Eigen::Index>(independent.size()));
  Eigen::MatrixXd rho(num_dependent, k);
  for (Eigen::Index j = 0; j < num_dependent; ++j) {
    const DependentRow& row = dependent[static_cast<std::size_t>(j)];
    rho.row(j) = row.residual.transpose();
    for (std::size_t i = 0; i < row.depends_on.size(); ++i) {
      const auto at = std::lower_bound(independent.begin(), independent.end(), row.depends_on[i]);
      W(j, at - independent.begin()) = row.weights[i];
    }
  }
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(num_dependent, num_dependent);
  const Eigen::MatrixXd shift = W.transpose() * (I + W * W.transpose()).llt().solve(rho);
  return IndependentRows(constraints, independent).smallest_solution(shift);
}

}  // namespace crease
