#include "Optimizers/HessianReduction.h"

#include <algorithm>
#include <span>

namespace crease {
namespace {

using RowSparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// Calls visit(row, column, weight) for the entries of the result's lower triangle that the entry
// (i, j), i >= j, of H contributes to.
template <typename Visit>
void for_each_target(const RowSparse& N, int k, int i, int j, Visit&& visit) {
  const int a = i % k;
  const int b = j % k;
  for (RowSparse::InnerIterator u(N, i / k); u; ++u) {
    for (RowSparse::InnerIterator v(N, j / k); v; ++v) {
      const int p = static_cast<int>(u.col()) * k + a;
      const int q = static_cast<int>(v.col()) * k + b;
      const double weight = u.value() * v.value();
      if (p >= q) visit(p, q, weight);
      if (i != j && q >= p) visit(q, p, weight);
    }
  }
}

}  // namespace

void HessianReduction::reduce(const RowSparse& N, Eigen::Index k,
                              const Eigen::SparseMatrix<double>& H,
                              Eigen::SparseMatrix<double>& reduced) {
  if (!knows(H)) analyse(N, k, H);
  const bool same_pattern =
      reduced.rows() == result_.rows() && reduced.nonZeros() == result_.nonZeros() &&
      reduced.isCompressed() &&
      std::equal(result_.outerIndexPtr(), result_.outerIndexPtr() + result_.cols() + 1,
                 reduced.outerIndexPtr()) &&
      std::equal(result_.innerIndexPtr(), result_.innerIndexPtr() + result_.nonZeros(),
                 reduced.innerIndexPtr());
  if (!same_pattern) reduced = result_;
  double* target = reduced.valuePtr();
  const double* source = H.valuePtr();
  std::fill(target, target + reduced.nonZeros(), 0.0);
  for (std::size_t s = 0; s < copy_target_.size(); ++s) {
    if (copy_target_[s] >= 0) target[copy_target_[s]] = source[s];
  }
  for (const Contribution& c : contributions_) target[c.target] += c.weight * source[c.source];
}

bool HessianReduction::knows(const Eigen::SparseMatrix<double>& H) const {
  return std::equal(outer_.begin(), outer_.end(), H.outerIndexPtr(),
                    H.outerIndexPtr() + H.outerSize() + 1) &&
         std::equal(inner_.begin(), inner_.end(), H.innerIndexPtr(),
                    H.innerIndexPtr() + H.nonZeros());
}

void HessianReduction::analyse(const RowSparse& N, Eigen::Index k,
                               const Eigen::SparseMatrix<double>& H) {
  outer_.assign(H.outerIndexPtr(), H.outerIndexPtr() + H.outerSize() + 1);
  inner_.assign(H.innerIndexPtr(), H.innerIndexPtr() + H.nonZeros());
  const auto size = static_cast<std::size_t>(k * N.cols());
  std::vector<std::size_t> first;
  const std::vector<Contribution> grouped = group_by_column(N, k, first);

  std::vector<int> start{0};
  std::vector<int> index;  // rows of the result, column by column
  std::vector<int> stored_at(size);
  std::vector<int> seen_in(size, -1);
  std::vector<int> copied_in(size, -1);
  copy_target_.assign(inner_.size(), -1);
  contributions_.clear();
  for (int q = 0; q < static_cast<int>(size); ++q) {
    const auto note = [&](int p) {
      if (seen_in[static_cast<std::size_t>(p)] == q) return;
      seen_in[static_cast<std::size_t>(p)] = q;
      index.push_back(p);
    };
    const std::span column(grouped.begin() + static_cast<std::ptrdiff_t>(first[q]),
                           grouped.begin() + static_cast<std::ptrdiff_t>(first[q + 1]));
    note(q);  // the diagonal always
    for (const Contribution& c : column) note(c.target);
    std::sort(index.begin() + start.back(), index.end());
    for (int e = start.back(); e < static_cast<int>(index.size()); ++e) stored_at[index[e]] = e;
    // The first source of weight 1 of a target is copied, all others are added.
    for (const Contribution& c : column) {
      int& copied = copy_target_[c.source];
      if (c.weight == 1.0 && copied < 0 && copied_in[c.target] != q) {
        copied = stored_at[c.target];
        copied_in[c.target] = q;
      } else {
        contributions_.push_back({c.source, stored_at[c.target], c.weight});
      }
    }
    start.push_back(static_cast<int>(index.size()));
  }
  result_.resize(static_cast<Eigen::Index>(size), static_cast<Eigen::Index>(size));
  result_.resizeNonZeros(static_cast<Eigen::Index>(index.size()));
  std::copy(start.begin(), start.end(), result_.outerIndexPtr());
  std::copy(index.begin(), index.end(), result_.innerIndexPtr());
  std::fill(result_.valuePtr(), result_.valuePtr() + index.size(), 0.0);
}

// What H's entries contribute, in the order of the result's columns; column q's begins at first[q]. The
// target is the row of the result.
std::vector<HessianReduction::Contribution> HessianReduction::group_by_column(
    const RowSparse& N, Eigen::Index k, std::vector<std::size_t>& first) const {
  const auto for_each_entry = [&](auto&& visit) {  // visit(entry of H, row, column, weight)
    for (int j = 0; j + 1 < static_cast<int>(outer_.size()); ++j) {
      for (int s = outer_[j]; s < outer_[j + 1]; ++s) {
        const int i = inner_[s];
        if (i < j) continue;  // upper triangle
        for_each_target(N, static_cast<int>(k), i, j,
                        [&](int p, int q, double weight) { visit(s, p, q, weight); });
      }
    }
  };
  first.assign(static_cast<std::size_t>(k * N.cols()) + 1, 0);
  for_each_entry([&](int, int, int q, double) { ++first[q + 1]; });
  for (std::size_t q = 1; q < first.size(); ++q) first[q] += first[q - 1];
  std::vector<Contribution> grouped(first.back());
  auto end = first;
  for_each_entry([&](int s, int p, int q, double weight) { grouped[end[q]++] = {s, p, weight}; });
  return grouped;
}

}  // namespace crease
