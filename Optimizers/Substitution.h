#pragma once

#include "Optimizers/NullSpace.h"
#include "Optimizers/ObjectiveFunction.h"
#include "Optimizers/SparseCholesky.h"

namespace crease {

/// The variables Z of a gradient method: Y = Y0 + R^-1 Z with R^T R = N^T P N, P the function's
/// preconditioner or, where it has none, the identity. Steepest descent in Z is the step -(N^T P N)^-1 N^T g
/// in Y; with P near the Hessian the number of iterations hardly grows when a mesh is refined, and with any P
/// every null space takes the same path.
///
/// A scalar P is factored once for all coordinates.
class Substitution {
 public:
  /// @param x   where the preconditioner is asked for.
  /// @param preconditioned  false: P is the identity.
  /// @throws InvalidInput when the preconditioner has a size that does not go with the unknowns, SolverError
  /// when it is not finite.
  Substitution(ObjectiveFunction& function, const Eigen::Ref<const Eigen::VectorXd>& x,
               const NullSpace& null_space, bool preconditioned);

  /// R^-1 z: a step in Y.
  Eigen::VectorXd step(const Eigen::Ref<const Eigen::VectorXd>& z) const;
  /// R^-T g: the gradient in Z of a gradient in Y.
  Eigen::VectorXd gradient(const Eigen::Ref<const Eigen::VectorXd>& g) const;
  /// Whether P is the function's own.
  bool preconditioned() const { return preconditioned_; }

 private:
  void factor(const NullSpace& null_space, const Eigen::SparseMatrix<double>& P);

  bool preconditioned_ = false;
  Eigen::Index columns_ = 1;  // that share the factor
  SparseCholesky factor_;
};

}  // namespace crease
