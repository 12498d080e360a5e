#pragma once

#include <Eigen/SparseCore>
#include <initializer_list>
#include <memory>

namespace crease {

/// Sparse Cholesky factorisation A = P^T L L^T P by CHOLMOD: supernodal where that pays, simplicial for
/// small or very sparse matrices, ordered by minimum degree. The pattern is analysed once and the numbers
/// are factored anew at each call. Same bits on any number of threads (all of it runs on the caller's).
///
/// Source: Y. Chen, T. A. Davis, W. W. Hager, S. Rajamanickam, "Algorithm 887: CHOLMOD", ACM TOMS 35(3), 2008.
class SparseCholesky {
 public:
  SparseCholesky();
  ~SparseCholesky();
  SparseCholesky(SparseCholesky&&) noexcept;
  SparseCholesky& operator=(SparseCholesky&&) noexcept;

  /// Factors the symmetric matrix whose lower triangle A holds (compressed, sorted; an upper triangle is
  /// ignored). Analyses the pattern when it is not that of the call before.
  /// @return false when A is not positive definite (or not finite); there is no factor then.
  /// @throws InvalidInput when A is not square or not compressed, SolverError when memory runs out.
  bool factor(const Eigen::SparseMatrix<double>& A);
  bool has_factor() const;
  Eigen::Index size() const;
  /// A^-1 b. @throws InvalidInput when there is no factor or the number of rows differs.
  Eigen::VectorXd solve(const Eigen::Ref<const Eigen::VectorXd>& b) const;
  /// A^-1 B for several right-hand sides at once.
  Eigen::MatrixXd solve_columns(const Eigen::Ref<const Eigen::MatrixXd>& B) const;
  /// With the root R = L^T P of A = R^T R: R^-1 B, which turns vectors whose length is Euclid's into
  /// vectors whose length A measures.
  Eigen::MatrixXd solve_root(const Eigen::Ref<const Eigen::MatrixXd>& B) const;
  /// R^-T B: carries gradients the other way.
  Eigen::MatrixXd solve_root_transpose(const Eigen::Ref<const Eigen::MatrixXd>& B) const;

  bool is_supernodal() const;
  /// Non-zeros of L (with the zeros that supernodes store).
  std::size_t num_nonzeros() const;

 private:
  struct State;
  Eigen::MatrixXd solve_systems(std::initializer_list<int> systems,
                                const Eigen::Ref<const Eigen::MatrixXd>& B) const;
  std::unique_ptr<State> state_;
};

}  // namespace crease
