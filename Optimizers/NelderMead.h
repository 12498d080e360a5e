#pragma once

#include <Eigen/Core>
#include <functional>

#include "Optimizers/Optimizer.h"

namespace crease {

/// When to stop.
struct NelderMeadOptions {
  double size_tolerance =
      0.05;  ///< stop when the simplex is smaller (mean distance from its centre)
  int max_evaluations = 500;
  /// Called after every iteration with the best point so far and its value; false ends the search.
  std::function<bool(const Eigen::VectorXd& x, double value)> after_iteration = nullptr;
};

/// The best point found.
struct NelderMeadResult {
  Eigen::VectorXd x;
  double value = 0.0;
  double initial_value = 0.0;
  int num_evaluations = 0;
  bool converged = false;  ///< by size; false: the limit of evaluations was reached
};

/// Minimises a function of a few parameters by values alone, by GSL's Nelder-Mead simplex
/// (nmsimplex2, deterministic). A value that is not a number counts as +infinity.
///
/// @param steps  edge of the first simplex along each parameter, not 0
/// @throws InvalidInput when the sizes differ, there is no parameter, or start or steps are not finite;
/// SolverError when the value at the start is not finite. What the function throws passes through.
NelderMeadResult nelder_mead(const std::function<double(const Eigen::VectorXd&)>& function,
                             const Eigen::VectorXd& start, const Eigen::VectorXd& steps,
                             const NelderMeadOptions& options = {});

/// The simplex that a NelderMead starts from and ends with, in the unit of ObjectiveFunction::step_length().
struct SimplexOptions {
  double first_edge = 4.0;
  double last_size =
      1e-3;  ///< ends below it, or below OptimizerOptions::step_length where that is larger
  int max_evaluations = 500;
};

/// nelder_mead() as an optimizer of few unknowns, rigid and affine maps: every unknown is scaled to the length
/// of its step. An iteration is an improvement; it costs one pass with gradient beside those for values alone,
/// for history and rules. Of the rules, decrease and step do not apply: a simplex may rest before it goes on.
///
/// Source: J. A. Nelder, R. Mead, "A Simplex Method for Function Minimization", Computer Journal 7, 1965.
class NelderMead final : public Optimizer {
 public:
  static constexpr Eigen::Index kMostUnknowns = 32;

  /// @throws InvalidInput for options out of range.
  explicit NelderMead(const OptimizerOptions& stopping = {}, const SimplexOptions& simplex = {});

  /// @throws InvalidInput for more than kMostUnknowns free unknowns, beside what every optimizer throws.
  OptimizerResult minimize(ObjectiveFunction& function, const Eigen::VectorXd& start,
                           const NullSpace* null_space = nullptr,
                           const ProgressCallback& progress = {}) const override;

 private:
  OptimizerOptions stopping_;
  SimplexOptions simplex_;
};

}  // namespace crease
