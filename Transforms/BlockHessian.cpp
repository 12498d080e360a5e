#include "Transforms/BlockHessian.h"

#include <algorithm>

#include "Core/Error.h"

namespace crease {

HessianPattern::HessianPattern(int num_control_points,
                               const std::vector<std::pair<int, int>>& couplings) {
  std::vector<std::pair<int, int>> pairs;
  pairs.reserve(couplings.size() + static_cast<std::size_t>(num_control_points));
  for (const auto& [i, k] : couplings) {
    if (std::min(i, k) < 0 || std::max(i, k) >= num_control_points) {
      throw InvalidInput(message("HessianPattern: the coupling (", i, ", ", k,
                                 ") names a control point outside 0..", num_control_points - 1));
    }
    if (i != k) pairs.emplace_back(std::max(i, k), std::min(i, k));
  }
  for (int i = 0; i < num_control_points; ++i) pairs.emplace_back(i, i);
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());

  row_start_.assign(static_cast<std::size_t>(num_control_points) + 1, 0);
  columns_.reserve(pairs.size());
  for (const auto& [i, k] : pairs) {
    ++row_start_[static_cast<std::size_t>(i) + 1];
    columns_.push_back(k);
  }
  for (std::size_t i = 1; i < row_start_.size(); ++i) row_start_[i] += row_start_[i - 1];
}

int HessianPattern::slot(int i, int k) const {
  const int row = std::max(i, k), column = std::min(i, k);
  if (column >= 0 && row < size()) {
    const auto begin = columns_.begin() + row_start_[static_cast<std::size_t>(row)];
    const auto end = columns_.begin() + row_start_[static_cast<std::size_t>(row) + 1];
    const auto found = std::lower_bound(begin, end, column);
    if (found != end && *found == column) return static_cast<int>(found - columns_.begin());
  }
  throw InvalidInput(message("HessianPattern: control points ", i, " and ", k,
                             " are not coupled; build the pattern from the couplings of every "
                             "energy and metric that adds to it."));
}

template <int Dim>
BlockHessian<Dim>::BlockHessian(std::shared_ptr<const HessianPattern> pattern)
    : pattern_(std::move(pattern)) {
  if (!pattern_) throw InvalidInput("BlockHessian: the pattern is null.");
  blocks_.resize(static_cast<std::size_t>(pattern_->num_entries()));
  set_zero();
}

template <int Dim>
void BlockHessian<Dim>::set_zero() {
  std::fill(blocks_.begin(), blocks_.end(), Matrix<Dim>::Zero());
}

template <int Dim>
void BlockHessian<Dim>::add(int i, int k, const Matrix<Dim>& block) {
  auto& entry = blocks_[static_cast<std::size_t>(pattern_->slot(i, k))];
  if (i >= k) {
    entry += block;
  } else {
    entry += block.transpose();
  }
}

template <int Dim>
BlockHessian<Dim>& BlockHessian<Dim>::operator+=(const BlockHessian& other) {
  if (pattern_ != other.pattern_ && (pattern_->row_start() != other.pattern_->row_start() ||
                                     pattern_->columns() != other.pattern_->columns())) {
    throw InvalidInput("BlockHessian: only matrices of the same pattern can be added.");
  }
  for (std::size_t s = 0; s < blocks_.size(); ++s) blocks_[s] += other.blocks_[s];
  return *this;
}

template <int Dim>
Eigen::SparseMatrix<double> BlockHessian<Dim>::to_sparse() const {
  const int n = pattern_->size();
  const auto& row_start = pattern_->row_start();
  const auto& columns = pattern_->columns();

  // Entries per column of blocks; within a column, rows ascend when the rows are visited in order.
  std::vector<int> below(static_cast<std::size_t>(n), 0);
  for (int k : columns) ++below[static_cast<std::size_t>(k)];

  Eigen::SparseMatrix<double> matrix(Dim * n, Dim * n);
  constexpr int kUpper = Dim * (Dim - 1) / 2;  // entries of a diagonal block above its diagonal
  matrix.resizeNonZeros(Dim * Dim * pattern_->num_entries() - kUpper * n);
  int* outer = matrix.outerIndexPtr();
  int* inner = matrix.innerIndexPtr();
  double* values = matrix.valuePtr();
  outer[0] = 0;
  for (int k = 0; k < n; ++k) {
    for (int b = 0; b < Dim; ++b) {
      outer[Dim * k + b + 1] = outer[Dim * k + b] + Dim * below[static_cast<std::size_t>(k)] - b;
    }
  }
  std::vector<int> next(outer, outer + Dim * n);
  for (int i = 0; i < n; ++i) {
    for (int s = row_start[i]; s < row_start[i + 1]; ++s) {
      const int k = columns[static_cast<std::size_t>(s)];
      const auto& block = blocks_[static_cast<std::size_t>(s)];
      for (int b = 0; b < Dim; ++b) {
        int& at = next[static_cast<std::size_t>(Dim * k + b)];
        for (int a = i == k ? b : 0; a < Dim; ++a, ++at) {
          inner[at] = Dim * i + a;
          values[at] = block(a, b);
        }
      }
    }
  }
  return matrix;
}

template class BlockHessian<2>;
template class BlockHessian<3>;

}  // namespace crease
