#pragma once

#include <Eigen/SparseCore>
#include <vector>

namespace crease {

/// Rows of Phi that occur in C ("touched", t of them) and those that do not; an orthonormal null space
/// needs to turn the former only. Y holds the untouched rows first, then the t - rank new coordinates.
struct TouchedRows {
  explicit TouchedRows(const Eigen::SparseMatrix<double, Eigen::RowMajor>& C);

  std::vector<int> touched;    ///< ascending
  std::vector<int> untouched;  ///< ascending
  std::vector<int> position;   ///< of each row of Phi within its list
  std::vector<bool> is_touched;
  /// C restricted to the touched columns, each row scaled to max |c| = 1 (rows of zeros stay), and
  /// these scales (1 for rows of zeros).
  Eigen::SparseMatrix<double> scaled(const Eigen::SparseMatrix<double, Eigen::RowMajor>& C,
                                     Eigen::VectorXd& scales) const;
};

}  // namespace crease
