#pragma once

#include <Eigen/Core>
#include <functional>

namespace crease {

/// When to stop.
struct NelderMeadOptions {
  double size_tolerance =
      0.05;  ///< stop when the simplex is smaller (mean distance from its centre)
  int max_evaluations = 500;
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

}  // namespace crease
