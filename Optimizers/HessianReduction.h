#pragma once

#include <Eigen/SparseCore>
#include <vector>

namespace crease {

/// (N (x) I_k)^T H (N (x) I_k) for a sparse N (m x n, rows) and a symmetric sparse H (k m), both fixed in
/// pattern, N also in value. The first call finds out where each entry of H goes; every further call is
/// one sweep over H's entries, in fixed order.
class HessianReduction {
 public:
  /// Reads the lower triangle of H (compressed), fills that of the result, diagonal always included.
  /// N and k must be those of the first call.
  void reduce(const Eigen::SparseMatrix<double, Eigen::RowMajor>& N, Eigen::Index k,
              const Eigen::SparseMatrix<double>& H, Eigen::SparseMatrix<double>& reduced);

 private:
  struct Contribution {
    int source;  // entry of H
    int target;  // entry of the result
    double weight;
  };
  bool knows(const Eigen::SparseMatrix<double>& H) const;
  void analyse(const Eigen::SparseMatrix<double, Eigen::RowMajor>& N, Eigen::Index k,
               const Eigen::SparseMatrix<double>& H);
  std::vector<Contribution> group_by_column(const Eigen::SparseMatrix<double, Eigen::RowMajor>& N,
                                            Eigen::Index k, std::vector<std::size_t>& first) const;

  std::vector<int> outer_, inner_;           // H's pattern
  Eigen::SparseMatrix<double> result_;       // the result's pattern, values zero
  std::vector<int> copy_target_;             // per entry of H: where it is copied to, -1 = nowhere
  std::vector<Contribution> contributions_;  // what is added after the copies
};

}  // namespace crease
