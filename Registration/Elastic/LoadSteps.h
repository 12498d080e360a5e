#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "Core/Error.h"
#include "Optimizers/DampedSolver.h"
#include "Optimizers/LinearConstraints.h"
#include "Optimizers/NullSpace.h"
#include "Registration/Landmarks.h"
#include "Transforms/AffineMap.h"
#include "Transforms/Energies/ElasticEnergy.h"
#include "Transforms/SplineTransform.h"

namespace crease {

/// How the load is divided.
enum class LoadSchedule {
  kFixed,    ///< `steps` equal ones
  kAdaptive  ///< from a quarter on, each twice as large as the last one where that went quickly
};

/// What follows each predicted step.
enum class LoadCorrector {
  kNewton,  ///< Newton's method to equilibrium
  /// Nothing, and residuals are ignored: forward Euler, which drifts off the equilibrium. For reproduction.
  kNone
};

/// How an elastic deformation is computed.
struct LoadStepOptions {
  LoadSchedule schedule = LoadSchedule::kFixed;
  int steps = 20;  ///< of the fixed schedule
  LoadCorrector corrector = LoadCorrector::kNewton;
  int max_iterations = 15;  ///< of Newton's method, per step
  double tolerance = 1e-8;  ///< of |N^T R|, relative to the norm of all reactions
  int max_halvings = 6;     ///< of a step that fails: down to 1/64 of the first one
  int max_failures = 40;    ///< steps that fail in all: no crawling towards a fold
  double snap_mm = 2;       ///< pairs outside the domain by no more are moved onto its border
  double suspicious_reaction = 20;  ///< times the median: larger ones are warned of
  NullSpaceKind null_space = NullSpaceKind::kElimination;
  /// kDirect: a sparse Cholesky factor per iteration. kPreconditionedCg: conjugate gradients with the factor
  /// of an earlier iteration, made anew when it has become too poor.
  LinearSolver solver = LinearSolver::kDirect;
};

/// One load step that was accepted.
struct LoadStepRecord {
  int step = 0;         ///< from 1
  double fraction = 0;  ///< of the whole load, after the step
  int newton_iterations = 0;
  /// |N^T R| over the norm of all reactions: after the predictor, then after each iteration.
  std::vector<double> residuals;
  double least_determinant = 1;  ///< of F over the quadrature points
  double largest_reaction = 0;   ///< E mm (2D): force per thickness
  int largest_reaction_row = 0;  ///< the constraint (pair) that has it, from 0
  int factorizations = 0;
  /// The last tangent of the step was not positive definite: it ended in an unstable equilibrium, or close to
  /// where the body becomes unstable.
  bool indefinite_tangent = false;

  double residual() const { return residuals.empty() ? 0.0 : residuals.back(); }
};

/// Called after each step; false cancels: the run ends with the state reached.
using LoadStepCallback = std::function<bool(const LoadStepRecord&)>;

/// A deformed body in equilibrium, and how it was reached.
struct LoadStepResult {
  ControlPoints<2> control_points;  ///< of u, mm
  double fraction = 0;              ///< of the load; 1 unless cancelled or failed
  double energy = 0;                ///< stored, E mm^2
  /// Forces on the constraints, C^T l = R: a row each, as many columns as the constraints have (one 2D force
  /// per pair), E mm; 0 for redundant constraints.
  RowMatrix reactions;
  std::vector<LoadStepRecord> steps;
  LeastDeterminant<2> least_determinant;
  /// The tangent is not positive definite: a small push would let the body leave this equilibrium (buckle).
  bool unstable = false;
  /// Of a quadrature that is not exact: relative_tangent_difference() from one that is.
  std::optional<double> quadrature_error;
  int factorizations = 0;
  int failures = 0;  ///< steps that failed
  std::vector<std::string> warnings;
};

/// No equilibrium was found: Newton's method failed, or the map folded, even in the smallest steps. The
/// message names the load fraction and the place.
class NoEquilibrium : public SolverError {
 public:
  NoEquilibrium(const std::string& text, LoadStepResult last)
      : SolverError(text), last_(std::make_shared<const LoadStepResult>(std::move(last))) {}
  /// The last state in equilibrium: the rest position if no step succeeded.
  const LoadStepResult& last_state() const { return *last_; }

 private:
  std::shared_ptr<const LoadStepResult> last_;  // shared: exceptions are copied
};

/// Deforms a body from rest (u = 0) by constraints C u = s d whose fraction s grows from 0 to 1. Each step
/// is predicted by the tangent and corrected by Newton's method, both in the null space of C:
///
///     predictor   K dU = -R,   C dU = ds d        corrector   K dU = -R,   C dU = 0
///     dU = N y + dU0,   (N^T K N) y = -N^T (R + K dU0)
///
/// The corrector ends when |N^T R| is small against the reactions; it searches along dU for a smaller W. A
/// step that does not converge, stays folded (det F <= 0) for some iterations, or ends so, is halved. The work is
/// bounded: in steps, in iterations per step, and in steps that fail. Where K is not positive definite it is shifted
/// (ElasticEquilibrium); whether the last equilibrium is stable is told by its own tangent.
///
/// @param constraints  for every coordinate alike (n rows by 2 columns) or coupling them (2 n rows by one).
/// @param basis        of the energy; tells places.
/// @throws InvalidInput for options out of range or constraints that contradict each other; NoEquilibrium.
/// Source: dissertation, (4.4) to (4.8), with a corrector that the text has not.
LoadStepResult run_load_steps(const ElasticEnergy<2>& energy, const SplineBasis<2>& basis,
                              const LinearConstraints& constraints,
                              const LoadStepOptions& options = {},
                              const LoadStepCallback& progress = {});

/// A body whose points are carried onto given places.
struct ElasticDeformation {
  std::shared_ptr<const SplineBasis<2>> basis;
  ElasticMaterial material;
  /// fixed[i] in the body goes to moving[i], exactly, mm.
  Landmarks<2> pairs;
  /// Numbers of the pairs on the contour, in order along it; empty: those within snap_mm of the border of a
  /// domain of triangles.
  std::vector<int> contour = {};
  /// T = A + u at rest; its strain counts.
  AffineMap<2> affine = {};
  ElasticQuadrature quadrature = ElasticQuadrature::kCells;
};

/// The same for pairs of points; `reactions` has one row per pair, warnings say that pairs were moved onto
/// the border, and which are held by suspicious forces.
/// @throws InvalidInput also when a pair lies outside the domain, contour pairs cross, or a connected part of
/// the domain holds fewer than two independent pairs.
LoadStepResult deform_elastically(const ElasticDeformation& deformation,
                                  const LoadStepOptions& options = {},
                                  const LoadStepCallback& progress = {});

/// The map T = A + u of a result.
SplineTransform<2> transform_of(const ElasticDeformation& deformation,
                                const LoadStepResult& result);

}  // namespace crease
