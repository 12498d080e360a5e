#pragma once

#include <Eigen/SparseCore>
#include <functional>
#include <optional>
#include <vector>

#include "Optimizers/LinearConjugateGradient.h"
#include "Optimizers/SparseCholesky.h"

namespace crease {

/// How Gauss-Newton solves (H + mu D) s = -g.
enum class LinearSolver {
  /// A sparse Cholesky factorisation of every system: the reference.
  kDirect,
  /// Conjugate gradients; the preconditioner is the factor of an earlier system, which is renewed when it
  /// has become too poor.
  kPreconditionedCg,
  /// Conjugate gradients; the preconditioner is one factor, an eighth to a quarter as costly, of the mean
  /// of H's k diagonal component blocks, for all k columns at once. As above where that fails.
  kScalarPreconditionedCg
};

/// How systems are solved, and how exactly.
struct LinearSolverOptions {
  LinearSolver kind = LinearSolver::kScalarPreconditionedCg;
  double cg_tolerance = 0.1;   ///< of the preconditioned residual, relative to its first norm
  int max_cg_iterations = 12;  ///< more: factor anew (three times as many for the scalar factor)
};

/// Solves (H + mu D) s = b for a sequence of Hessians of one pattern; D = |diag(H)|, not below 1e-6 of its
/// mean. Keeps what may serve the next system: analysis of the pattern, a factor as preconditioner.
class DampedSolver {
 public:
  /// @param k  columns of the unknowns (control-point-major): the blocks that the scalar factor averages.
  DampedSolver(const LinearSolverOptions& options, Eigen::Index k) : options_(options), k_(k) {}

  /// The matrix to fill (lower triangle with full diagonal, compressed) before hessian_changed().
  Eigen::SparseMatrix<double>& hessian() { return A_; }
  void hessian_changed();
  /// nullopt when the damped matrix is not positive definite or not finite.
  std::optional<Eigen::VectorXd> solve(const Eigen::Ref<const Eigen::VectorXd>& b, double damping);

  /// Counted from the beginning, or from the last call of start_counting().
  void start_counting() { factorizations_ = cg_iterations_ = 0; }
  int num_factorizations() const { return factorizations_; }
  int num_cg_iterations() const { return cg_iterations_; }

 private:
  using Result = std::optional<Eigen::VectorXd>;
  using Preconditioner = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;
  void set_damping(double damping);
  Result solve_direct(const Eigen::Ref<const Eigen::VectorXd>& b);
  Result solve_with_kept_factor(const Eigen::Ref<const Eigen::VectorXd>& b);
  Result solve_with_scalar_factor(const Eigen::Ref<const Eigen::VectorXd>& b);
  Result conjugate_gradients(const Eigen::Ref<const Eigen::VectorXd>& b, int max_iterations,
                             const Preconditioner& preconditioner);
  bool factor_scalar();
  void analyse_scalar();

  LinearSolverOptions options_;
  Eigen::Index k_;
  Eigen::SparseMatrix<double> A_;  // lower triangle of H + mu D
  Eigen::VectorXd diagonal_;       // of H
  SparseCholesky factor_;          // of A_ or of an earlier one
  SparseCholesky scalar_factor_;
  Eigen::SparseMatrix<double> scalar_;  // mean over the components of A_'s blocks
  std::vector<int> scalar_target_;      // per entry of A_: its entry in scalar_, -1 = none
  int factorizations_ = 0;
  int cg_iterations_ = 0;
};

}  // namespace crease
