#pragma once

#include <memory>

#include "Optimizers/Optimizer.h"

namespace crease {

/// The optimizers by name.
enum class OptimizerKind {
  kGaussNewton,        ///< GaussNewton
  kLbfgs,              ///< Lbfgs
  kConjugateGradient,  ///< NonlinearConjugateGradient
  kSteepestDescent,    ///< SteepestDescent
  kNelderMead          ///< NelderMead: for few unknowns
};

/// An optimizer of the kind with its default options and these stopping rules.
/// @throws InvalidInput as check_options().
std::unique_ptr<Optimizer> make_optimizer(OptimizerKind kind, const OptimizerOptions& stopping);

}  // namespace crease
