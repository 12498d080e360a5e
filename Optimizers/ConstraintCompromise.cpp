#include "Optimizers/ConstraintCompromise.h"

#include <Eigen/SVD>
#include <algorithm>
#include <utility>

#include "Core/Error.h"
#include "Optimizers/TouchedRows.h"

namespace crease {
namespace {

constexpr double kRounding = 1e-9;  // of the largest singular value

using RowSparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

void add_row(const RowSparse& from, int row, int to, std::vector<Eigen::Triplet<double>>& entries) {
  for (RowSparse::InnerIterator entry(from, row); entry; ++entry) {
    entries.emplace_back(to, static_cast<int>(entry.col()), entry.value());
  }
}

RowSparse sparse(Eigen::Index rows, Eigen::Index cols,
                 const std::vector<Eigen::Triplet<double>>& entries) {
  RowSparse matrix(rows, cols);
  matrix.setFromTriplets(entries.begin(), entries.end());
  matrix.makeCompressed();
  return matrix;
}

}  // namespace

LinearConstraints compromise(const LinearConstraints& constraints, std::span<const int> rows,
                             double least_share) {
  const Eigen::Index m = constraints.C.cols(), k = constraints.d.cols();
  std::vector<Eigen::Triplet<double>> replaced, entries;
  Eigen::MatrixXd d(std::ssize(rows), k);
  for (int i = 0; i < static_cast<int>(rows.size()); ++i) {
    add_row(constraints.C, rows[i], i, replaced);
    d.row(i) = constraints.d.row(rows[i]);
  }
  const RowSparse C = sparse(std::ssize(rows), m, replaced);
  const TouchedRows columns(C);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(C.rows(), std::ssize(columns.touched));
  for (const auto& entry : replaced) {
    dense(entry.row(), columns.position[static_cast<std::size_t>(entry.col())]) += entry.value();
  }
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(dense, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& S = svd.singularValues();
  const double least =
      std::max(kRounding * S.maxCoeff(), least_share * dense.rowwise().norm().maxCoeff());
  const Eigen::Index rank = (S.array() >= least).count();
  LinearConstraints result;
  result.d.resize(constraints.C.rows() - std::ssize(rows) + rank, k);
  int count = 0;
  for (int i = 0; i < constraints.C.rows(); ++i) {
    if (std::ranges::find(rows, i) != rows.end()) continue;
    result.d.row(count) = constraints.d.row(i);
    result.names.push_back(constraints.name(i));
    add_row(constraints.C, i, count++, entries);
  }
  for (Eigen::Index n = 0; n < rank; ++n, ++count) {
    for (Eigen::Index j = 0; j < dense.cols(); ++j) {
      entries.emplace_back(count, columns.touched[static_cast<std::size_t>(j)],
                           svd.matrixV()(j, n));
    }
    result.d.row(count) = svd.matrixU().col(n).transpose() * d / S[n];
    result.names.push_back(message("compromise ", n + 1));
  }
  result.C = sparse(count, m, entries);
  return result;
}

}  // namespace crease
