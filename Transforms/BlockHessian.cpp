#include "Transforms/BlockHessian.h"

#include <algorithm>

#include "Core/Error.h"
#include "Core/Parallel.h"

namespace crease {
namespace {

/// First entry of column Dim k + b: the diagonal block gives Dim - b entries, each other block Dim.
template <int Dim>
std::vector<int> column_starts(const HessianPattern& pattern) {
  std::vector<int> start{0};
  for (int blocks : pattern.column_sizes()) {
    for (int b = 0; b < Dim; ++b) start.push_back(start.back() + Dim * blocks - b);
  }
  return start;
}

}  // namespace

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
  column_sizes_.assign(static_cast<std::size_t>(num_control_points), 0);
  for (int k : columns_) rank_in_column_.push_back(column_sizes_[static_cast<std::size_t>(k)]++);
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
  Eigen::SparseMatrix<double> matrix;
  to_sparse(matrix);
  return matrix;
}

template <int Dim>
bool BlockHessian<Dim>::has_structure(const Eigen::SparseMatrix<double>& matrix) const {
  const int n = pattern_->size();
  if (matrix.rows() != Dim * n || matrix.cols() != Dim * n || !matrix.isCompressed()) return false;
  const auto start = column_starts<Dim>(*pattern_);
  if (!std::equal(start.begin(), start.end(), matrix.outerIndexPtr())) return false;
  for (int i = 0; i < n; ++i) {
    for (int s = pattern_->row_start()[i]; s < pattern_->row_start()[i + 1]; ++s) {
      const int column = Dim * pattern_->columns()[s] + Dim - 1;
      const int last = start[column] + Dim * pattern_->rank_in_column()[s];
      if (matrix.innerIndexPtr()[last] != Dim * i + Dim - 1) return false;
    }
  }
  return true;
}

template <int Dim>
void BlockHessian<Dim>::make_structure(Eigen::SparseMatrix<double>& matrix) const {
  const int n = pattern_->size();
  const auto start = column_starts<Dim>(*pattern_);
  matrix.resize(Dim * n, Dim * n);
  matrix.resizeNonZeros(start.back());
  std::copy(start.begin(), start.end(), matrix.outerIndexPtr());
  for (int i = 0; i < n; ++i) {
    for (int s = pattern_->row_start()[i]; s < pattern_->row_start()[i + 1]; ++s) {
      for (int b = 0; b < Dim; ++b) {
        const int column = Dim * pattern_->columns()[s] + b;
        const int first = start[column] + Dim * pattern_->rank_in_column()[s] - b;
        for (int a = pattern_->rank_in_column()[s] == 0 ? b : 0; a < Dim; ++a) {
          matrix.innerIndexPtr()[first + a] = Dim * i + a;
        }
      }
    }
  }
}

template <int Dim>
void BlockHessian<Dim>::to_sparse(Eigen::SparseMatrix<double>& matrix) const {
  if (!has_structure(matrix)) make_structure(matrix);
  const int* start = matrix.outerIndexPtr();
  double* values = matrix.valuePtr();
  constexpr int kRowsAtOnce = 256;
  const int n = pattern_->size();
  parallel_for((n + kRowsAtOnce - 1) / kRowsAtOnce, [&](std::int64_t part) {
    const int begin = static_cast<int>(part) * kRowsAtOnce;
    const int first_slot = pattern_->row_start()[begin];
    const int last_slot = pattern_->row_start()[std::min(n, begin + kRowsAtOnce)];
    for (int s = first_slot; s < last_slot; ++s) {
      const int rank = pattern_->rank_in_column()[s];
      for (int b = 0; b < Dim; ++b) {
        double* first = values + start[Dim * pattern_->columns()[s] + b] + Dim * rank - b;
        for (int a = rank == 0 ? b : 0; a < Dim; ++a) first[a] = blocks_[s](a, b);
      }
    }
  });
}

template class BlockHessian<2>;
template class BlockHessian<3>;

}  // namespace crease
