#pragma once

#include <Eigen/Cholesky>
#include <optional>
#include <string>

#include "Optimizers/DampedSolver.h"
#include "Optimizers/NullSpace.h"
#include "Registration/Elastic/LoadSteps.h"
#include "Transforms/Energies/ElasticEnergy.h"

namespace crease {

/// The state of a body under constraints, with what is known of it, and the steps that load it further.
///
/// Where the reduced tangent H = N^T K N is not positive definite, the body can buckle, and a Newton step may
/// lead uphill or to a saddle. Then H + mu D takes its place (DampedSolver), and
/// mu the first of 1e-4, 1e-3, .. for which a Cholesky factor exists: one does in the end, for large mu makes
/// the diagonal dominate. The step is then one of descent for W, as it would be with a shifted LDL^T factor.
/// All that such a factor of H itself would add is the number of negative pivots, and all that is asked here
/// is whether there are any. D rather than the identity makes steps independent of the unit of stress, and
/// lets soft tissue move where stiff tissue buckles.
class ElasticEquilibrium {
 public:
  /// All must outlive this. @param null_space  of C U = d, d the whole load.
  ElasticEquilibrium(const ElasticEnergy<2>& energy, const NullSpace& null_space,
                     const LoadStepOptions& options);

  /// Adds a share of the load: predictor, and corrector unless that is off. Fills the record but for its step
  /// and fraction.
  /// @return why it failed, with the place if that is known; the state is then what it was.
  std::optional<std::string> advance(double share, const SplineBasis<2>& basis,
                                     LoadStepRecord& record);

  const ControlPoints<2>& control_points() const { return state_.phi; }
  double energy() const { return state_.energy; }
  const LeastDeterminant<2>& least_determinant() const { return state_.least; }
  const RowMatrix& reactions() const { return state_.reactions; }
  /// Whether the tangent is positive definite in this very state: W is at a minimum, which no small push can
  /// leave. One factorization.
  bool stable();
  int num_factorizations() const { return solver_.num_factorizations() + further_factorizations_; }

 private:
  struct State {
    ControlPoints<2> phi;
    double energy = 0;
    LeastDeterminant<2> least;
    Eigen::VectorXd force;    // R = dW/dU, stacked
    Eigen::VectorXd reduced;  // N^T R
    RowMatrix reactions;
    double residual = 0;  // |N^T R| over that of the reactions
  };
  State evaluate(ControlPoints<2> phi) const;
  void assemble();
  std::optional<Eigen::VectorXd> solve(const Eigen::VectorXd& rhs, bool& indefinite);
  std::optional<std::string> predict(double share, bool& indefinite);
  std::optional<std::string> correct(const SplineBasis<2>& basis, LoadStepRecord& record);
  bool search(const Eigen::VectorXd& step);
  std::string fold_text() const;
  std::string worst_place(const SplineBasis<2>& basis) const;

  const ElasticEnergy<2>& energy_;
  const NullSpace& null_space_;
  const LoadStepOptions& options_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> independent_;  // rows of C
  Eigen::LDLT<Eigen::MatrixXd> gram_;                         // of C C^T
  double force_floor_;  // below which reactions are rounding, E mm
  DampedSolver solver_;
  int further_factorizations_ = 0;
  BlockHessian<2> hessian_;
  Eigen::SparseMatrix<double> tangent_;  // K, lower triangle
  State state_;
};

}  // namespace crease
