#pragma once

#include "Optimizers/Optimizer.h"

namespace crease {

/// How the next direction is made of gradients.
enum class LineSearchDirection { kLbfgs, kConjugateGradient };

/// What the methods with a line search by Wolfe's conditions have in common.
struct LineSearchOptions {
  LineSearchDirection direction = LineSearchDirection::kLbfgs;
  int memory = 10;                  ///< pairs of steps and changes of the gradient (L-BFGS)
  bool precondition = true;         ///< by ObjectiveFunction::preconditioner(), where there is one
  double first_step = 1.0;          ///< step_length() of the first trial where there is none
  double curvature_decrease = 0.9;  ///< Wolfe: share of the slope that may be left
};

/// @throws InvalidInput for options out of range.
void check_options(const LineSearchOptions& options, const char* method);

/// Minimises by Ceres' line search minimiser (GradientProblem) in the variables of a Substitution, with the
/// stopping rules, history and callbacks of all optimizers. Trial points of infinite value are shortened.
OptimizerResult minimize_by_line_search(ObjectiveFunction& function, const Eigen::VectorXd& start,
                                        const NullSpace* null_space,
                                        const OptimizerOptions& stopping,
                                        const LineSearchOptions& options,
                                        const ProgressCallback& progress);

}  // namespace crease
