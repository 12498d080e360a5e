#pragma once

#include <Eigen/Core>

#include "Optimizers/NullSpace.h"
#include "Optimizers/ObjectiveFunction.h"

namespace crease::testing {

/// GSL's minimisers with gradients, written by others, to check ours against.
enum class GslMethod { kBfgs, kPolakRibiere };

/// The minimum over x = N y + x0 by vector_bfgs2 or conjugate_pr.
struct GslMinimum {
  double value = 0.0;
  Eigen::VectorXd x;
  double gradient_norm = 0.0;
};
GslMinimum gsl_minimum(GslMethod method, ObjectiveFunction& function, const NullSpace& null_space,
                       const Eigen::VectorXd& start);

}  // namespace crease::testing
