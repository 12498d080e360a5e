#include "Optimizers/RowDependencies.h"

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

}  // namespace crease
