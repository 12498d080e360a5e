#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <utility>
#include <vector>

#include "Core/Point.h"

namespace crease {

/// Which pairs of control points interact: the lower triangle (k <= i), row by row.
class HessianPattern {
 public:
  /// @param couplings  pairs in any order and orientation; the diagonal is always included.
  HessianPattern(int num_control_points, const std::vector<std::pair<int, int>>& couplings);

  int size() const { return static_cast<int>(row_start_.size()) - 1; }
  int num_entries() const { return static_cast<int>(columns_.size()); }
  /// Entry of the pair (i, k) in either order. @throws InvalidInput when it is not in the pattern.
  int slot(int i, int k) const;
  const std::vector<int>& row_start() const { return row_start_; }
  const std::vector<int>& columns() const { return columns_; }
  /// How many entries of its column lie above an entry: 0 on the diagonal.
  const std::vector<int>& rank_in_column() const { return rank_in_column_; }
  /// Number of entries of each column.
  const std::vector<int>& column_sizes() const { return column_sizes_; }

 private:
  std::vector<int> row_start_;
  std::vector<int> columns_;
  std::vector<int> rank_in_column_, column_sizes_;
};

/// A symmetric matrix over the stacked control points (parameter Dim * i + a is coordinate a of control
/// point i), stored as one Dim x Dim block per pair of the pattern. Every energy and metric adds its
/// second derivatives here.
template <int Dim>
class BlockHessian {
 public:
  explicit BlockHessian(std::shared_ptr<const HessianPattern> pattern);

  const HessianPattern& pattern() const { return *pattern_; }
  void set_zero();
  /// Adds the block of rows i and columns k; its transpose stands for (k, i) and is not added again.
  void add(int i, int k, const Matrix<Dim>& block);
  /// The block of an entry of the pattern, row = coordinate of the larger control point.
  Matrix<Dim>& block(int slot) { return blocks_[static_cast<std::size_t>(slot)]; }
  const Matrix<Dim>& block(int slot) const { return blocks_[static_cast<std::size_t>(slot)]; }
  BlockHessian& operator+=(const BlockHessian& other);
  /// Lower triangle as a sparse matrix, (Dim * n)^2, column-major, with the same pattern at every call.
  Eigen::SparseMatrix<double> to_sparse() const;
  /// The same into a matrix of an earlier call, of which only the values are written anew.
  void to_sparse(Eigen::SparseMatrix<double>& matrix) const;

 private:
  bool has_structure(const Eigen::SparseMatrix<double>& matrix) const;
  void make_structure(Eigen::SparseMatrix<double>& matrix) const;

  std::shared_ptr<const HessianPattern> pattern_;
  std::vector<Matrix<Dim>> blocks_;
};

extern template class BlockHessian<2>;
extern template class BlockHessian<3>;

}  // namespace crease
