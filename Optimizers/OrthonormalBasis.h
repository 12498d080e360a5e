#pragma once

#include <Eigen/SparseCore>
#include <functional>

#include "Optimizers/LinearConstraints.h"
#include "Optimizers/TouchedRows.h"

namespace crease {

/// N = [I, N_T] with orthonormal columns: the identity on the rows of Phi that occur in no constraint, and
/// on the t that do a basis N_T (t x num_turned), known by what it does to dense columns only.
/// Y holds the untouched rows first, then the num_turned new coordinates; k columns throughout.
class OrthonormalBasis {
 public:
  using Action = std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>;
  /// @param turn       M -> N_T M
  /// @param turn_back  M -> N_T^T M
  OrthonormalBasis(TouchedRows rows, Eigen::Index k, Eigen::Index num_turned, Action turn,
                   Action turn_back);

  Eigen::VectorXd apply(const Eigen::Ref<const Eigen::VectorXd>& y) const;
  Eigen::VectorXd apply_transpose(const Eigen::Ref<const Eigen::VectorXd>& g) const;
  /// (N (x) I_k)^T H (N (x) I_k), lower triangle, for the k given: sparse among untouched rows, dense strips
  /// for the new coordinates.
  void reduce(const Eigen::SparseMatrix<double>& H, Eigen::Index k,
              Eigen::SparseMatrix<double>& reduced) const;

 private:
  TouchedRows rows_;
  Eigen::Index k_;
  Eigen::Index num_turned_;
  Action turn_, turn_back_;
};

}  // namespace crease
