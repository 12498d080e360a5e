#include "Optimizers/SvdNullSpace.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <utility>

namespace crease {
namespace {
constexpr double kRankTolerance = 1e-9;  // of the largest singular value
}

SvdNullSpace::SvdNullSpace(LinearConstraints constraints, Eigen::Index m)
    : NullSpace(std::move(constraints), m) {
  const TouchedRows rows(this->constraints().C);
  Eigen::VectorXd scales;
  const Eigen::MatrixXd C = rows.scaled(this->constraints().C, scales);
  const Eigen::Index t = C.cols();
  Eigen::Index rank = 0;
  Eigen::MatrixXd turned = Eigen::MatrixXd::Identity(t, t);
  if (C.size() > 0) {
    const Eigen::BDCSVD<Eigen::MatrixXd> svd(C, Eigen::ComputeFullV);
    singular_values_ = svd.singularValues();
    rank = (singular_values_.array() > kRankTolerance * singular_values_[0]).count();
    turned = svd.matrixV().rightCols(t - rank);
  }
  basis_.emplace(
      rows, num_columns(), t - rank,
      [turned](const Eigen::MatrixXd& M) -> Eigen::MatrixXd { return turned * M; },
      [turned](const Eigen::MatrixXd& M) -> Eigen::MatrixXd { return turned.transpose() * M; });

  // Which rows make the rank, and the smallest Phi0 that meets them: C^T P = Q R by columns.
  std::vector<int> independent;
  std::vector<int> dependent;
  if (rank > 0) {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(C.transpose());
    const auto& order = qr.colsPermutation().indices();
    independent.assign(order.data(), order.data() + rank);
    dependent.assign(order.data() + rank, order.data() + order.size());
    Eigen::MatrixXd rhs(rank, num_columns());
    for (Eigen::Index i = 0; i < rank; ++i) {
      rhs.row(i) = this->constraints().d.row(order[i]) / scales[order[i]];
    }
    Eigen::MatrixXd padded = Eigen::MatrixXd::Zero(t, num_columns());
    padded.topRows(rank) = qr.matrixQR()
                               .topLeftCorner(rank, rank)
                               .triangularView<Eigen::Upper>()
                               .transpose()
                               .solve(rhs);
    const Eigen::MatrixXd phi = qr.householderQ() * padded;
    for (Eigen::Index i = 0; i < t; ++i) {
      offset_.row(rows.touched[static_cast<std::size_t>(i)]) = phi.row(i);
    }
  } else {
    for (int j = 0; j < static_cast<int>(C.rows()); ++j) dependent.push_back(j);
  }
  std::sort(independent.begin(), independent.end());
  std::sort(dependent.begin(), dependent.end());
  set_rows(std::move(independent), dependent);
}

Eigen::VectorXd SvdNullSpace::multiply(const Eigen::Ref<const Eigen::VectorXd>& y) const {
  return basis_->apply(y);
}

Eigen::VectorXd SvdNullSpace::multiply_transpose(const Eigen::Ref<const Eigen::VectorXd>& g) const {
  return basis_->apply_transpose(g);
}

Eigen::VectorXd SvdNullSpace::divide_by_gram(const Eigen::Ref<const Eigen::VectorXd>& g) const {
  return g;
}

Eigen::VectorXd SvdNullSpace::project(const Eigen::Ref<const Eigen::VectorXd>& step) const {
  return basis_->apply_transpose(step);
}

void SvdNullSpace::reduce(const Eigen::SparseMatrix<double>& H, Eigen::Index k,
                          Eigen::SparseMatrix<double>& reduced) const {
  basis_->reduce(H, k, reduced);
}

}  // namespace crease
