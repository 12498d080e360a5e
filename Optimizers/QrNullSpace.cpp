#include "Optimizers/QrNullSpace.h"

#include <SuiteSparseQR.hpp>
#include <algorithm>
#include <memory>
#include <utility>

#include "Core/Error.h"
#include "Optimizers/LibraryThreads.h"

namespace crease {
namespace {

constexpr double kDeadColumn = 1e-9;  // norm, for columns of largest entry 1

// The factorisation A P = Q [R; 0] of a sparse A (t x r) with Q as Householder vectors.
class HouseholderFactor {
 public:
  explicit HouseholderFactor(const Eigen::SparseMatrix<double>& A);
  ~HouseholderFactor();
  HouseholderFactor(const HouseholderFactor&) = delete;
  HouseholderFactor& operator=(const HouseholderFactor&) = delete;

  Eigen::Index rank() const { return rank_; }
  /// Column of A at position n of A P; the first rank() are independent.
  int column(Eigen::Index n) const {
    return E_ == nullptr ? static_cast<int>(n) : static_cast<int>(E_[n]);
  }
  /// The leading rank x rank block of R, upper triangular.
  const Eigen::SparseMatrix<double>& R() const { return leading_R_; }
  Eigen::MatrixXd apply(const Eigen::MatrixXd& M) const { return multiply(SPQR_QX, M); }
  Eigen::MatrixXd apply_transpose(const Eigen::MatrixXd& M) const { return multiply(SPQR_QTX, M); }

 private:
  Eigen::MatrixXd multiply(int method, const Eigen::MatrixXd& M) const;

  mutable cholmod_common common_{};
  cholmod_sparse* H_ = nullptr;
  cholmod_dense* tau_ = nullptr;
  SuiteSparse_long* row_order_ = nullptr;
  SuiteSparse_long* E_ = nullptr;
  Eigen::Index num_rows_, num_columns_;
  Eigen::Index rank_ = 0;
  Eigen::SparseMatrix<double> leading_R_;
};

HouseholderFactor::HouseholderFactor(const Eigen::SparseMatrix<double>& A)
    : num_rows_(A.rows()), num_columns_(A.cols()) {
  const SingleThreadedLibraries single;
  cholmod_l_start(&common_);
  common_.print = 0;
  cholmod_sparse* copy = cholmod_l_allocate_sparse(
      static_cast<std::size_t>(A.rows()), static_cast<std::size_t>(A.cols()),
      static_cast<std::size_t>(A.nonZeros()), 1, 1, 0, CHOLMOD_REAL, &common_);
  if (copy == nullptr) throw SolverError("QR factorisation of the constraints: out of memory.");
  std::copy(A.outerIndexPtr(), A.outerIndexPtr() + A.cols() + 1,
            static_cast<SuiteSparse_long*>(copy->p));
  std::copy(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(),
            static_cast<SuiteSparse_long*>(copy->i));
  std::copy(A.valuePtr(), A.valuePtr() + A.nonZeros(), static_cast<double*>(copy->x));
  cholmod_sparse* R = nullptr;
  rank_ =
      SuiteSparseQR<double>(SPQR_ORDERING_DEFAULT, kDeadColumn, A.rows(), 0, copy, nullptr, nullptr,
                            nullptr, nullptr, &R, &E_, &H_, &row_order_, &tau_, &common_);
  cholmod_l_free_sparse(&copy, &common_);
  if (rank_ < 0 || R == nullptr) {
    throw SolverError(message("QR factorisation of the constraints failed (SPQR status ",
                              common_.status, "); use the null space by elimination."));
  }
  std::vector<Eigen::Triplet<double>> entries;
  const auto* start = static_cast<const SuiteSparse_long*>(R->p);
  const auto* row = static_cast<const SuiteSparse_long*>(R->i);
  const auto* value = static_cast<const double*>(R->x);
  for (SuiteSparse_long j = 0; j < rank_; ++j) {
    for (SuiteSparse_long s = start[j]; s < start[j + 1]; ++s) {
      if (row[s] < rank_) {
        entries.emplace_back(static_cast<int>(row[s]), static_cast<int>(j), value[s]);
      }
    }
  }
  leading_R_.resize(rank_, rank_);
  leading_R_.setFromTriplets(entries.begin(), entries.end());
  cholmod_l_free_sparse(&R, &common_);
}

HouseholderFactor::~HouseholderFactor() {
  cholmod_l_free_sparse(&H_, &common_);
  cholmod_l_free_dense(&tau_, &common_);
  cholmod_l_free(static_cast<std::size_t>(num_rows_), sizeof(SuiteSparse_long), row_order_,
                 &common_);
  cholmod_l_free(static_cast<std::size_t>(num_columns_), sizeof(SuiteSparse_long), E_, &common_);
  cholmod_l_finish(&common_);
}

Eigen::MatrixXd HouseholderFactor::multiply(int method, const Eigen::MatrixXd& M) const {
  if (M.cols() == 0) return M;
  const SingleThreadedLibraries single;
  cholmod_dense view{};
  view.nrow = static_cast<std::size_t>(M.rows());
  view.ncol = static_cast<std::size_t>(M.cols());
  view.nzmax = view.nrow * view.ncol;
  view.d = view.nrow;
  view.x = const_cast<double*>(M.data());
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* product =
      SuiteSparseQR_qmult<double>(method, H_, tau_, row_order_, &view, &common_);
  if (product == nullptr) throw SolverError("QR factorisation of the constraints: out of memory.");
  Eigen::MatrixXd result =
      Eigen::Map<const Eigen::MatrixXd>(static_cast<const double*>(product->x), M.rows(), M.cols());
  cholmod_l_free_dense(&product, &common_);
  return result;
}

Eigen::MatrixXd padded(const Eigen::MatrixXd& M, Eigen::Index above, Eigen::Index below) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(above + M.rows() + below, M.cols());
  result.middleRows(above, M.rows()) = M;
  return result;
}

}  // namespace

QrNullSpace::QrNullSpace(LinearConstraints constraints, Eigen::Index m)
    : NullSpace(std::move(constraints), m) {
  const auto& [C, d, names] = this->constraints();
  const TouchedRows rows(C);
  Eigen::VectorXd scales;
  const Eigen::SparseMatrix<double> transposed = rows.scaled(C, scales).transpose();
  const Eigen::Index t = transposed.rows();
  if (t == 0) {  // no constraint but perhaps rows of zeros
    const auto keep = [](const Eigen::MatrixXd& M) { return M; };
    basis_.emplace(rows, num_columns(), 0, keep, keep);
    std::vector<int> zeros;
    for (int j = 0; j < static_cast<int>(C.rows()); ++j) zeros.push_back(j);
    set_rows({}, zeros);
    return;
  }
  const auto factor = std::make_shared<const HouseholderFactor>(transposed);
  const Eigen::Index rank = factor->rank();
  std::vector<int> independent;
  std::vector<int> dependent;
  Eigen::MatrixXd rhs(rank, num_columns());
  for (Eigen::Index n = 0; n < C.rows(); ++n) {
    const int row = factor->column(n);
    (n < rank ? independent : dependent).push_back(row);
    if (n < rank) rhs.row(n) = d.row(row) / scales[row];
  }
  const Eigen::MatrixXd solved = factor->R().transpose().triangularView<Eigen::Lower>().solve(rhs);
  const Eigen::MatrixXd phi = factor->apply(padded(solved, 0, t - rank));
  for (Eigen::Index i = 0; i < t; ++i) {
    offset_.row(rows.touched[static_cast<std::size_t>(i)]) = phi.row(i);
  }
  basis_.emplace(
      rows, num_columns(), t - rank,
      [factor, rank](const Eigen::MatrixXd& M) { return factor->apply(padded(M, rank, 0)); },
      [factor, t, rank](const Eigen::MatrixXd& M) -> Eigen::MatrixXd {
        return factor->apply_transpose(M).bottomRows(t - rank);
      });
  std::sort(independent.begin(), independent.end());
  std::sort(dependent.begin(), dependent.end());
  set_rows(std::move(independent), dependent);
}

Eigen::VectorXd QrNullSpace::multiply(const Eigen::Ref<const Eigen::VectorXd>& y) const {
  return basis_->apply(y);
}

Eigen::VectorXd QrNullSpace::multiply_transpose(const Eigen::Ref<const Eigen::VectorXd>& g) const {
  return basis_->apply_transpose(g);
}

Eigen::VectorXd QrNullSpace::divide_by_gram(const Eigen::Ref<const Eigen::VectorXd>& g) const {
  return g;
}

Eigen::VectorXd QrNullSpace::project(const Eigen::Ref<const Eigen::VectorXd>& step) const {
  return basis_->apply_transpose(step);
}

void QrNullSpace::reduce(const Eigen::SparseMatrix<double>& H, Eigen::Index k,
                         Eigen::SparseMatrix<double>& reduced) const {
  basis_->reduce(H, k, reduced);
}

}  // namespace crease
