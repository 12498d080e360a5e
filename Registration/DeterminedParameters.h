#pragma once

#include "Optimizers/DampedSolver.h"
#include "Optimizers/NullSpace.h"
#include "Optimizers/ObjectiveFunction.h"

namespace crease {

/// How many of the free parameters the images determine, rather than what is asked of the motion besides:
/// trace((J + P)^-1 J), J the Gauss-Newton matrix of the image term and P that of the energies, both in
/// the null space of the constraints. Between 0 and the number of free parameters.
///
/// The trace is the mean of z^T (J + P)^-1 J z over a few vectors of random signs, always the same ones;
/// its relative error is about (2 / (probes x trace))^1/2.
/// Sources: D. J. C. MacKay, "Bayesian Interpolation", Neural Computation 4, 1992, for the number of
/// well-determined parameters; M. F. Hutchinson, "A stochastic estimator of the trace",
/// Communications in Statistics 18, 1989, for the estimate.
/// @param image   alpha E_I alone; `whole` the whole cost; both are evaluated at `phi`.
/// @param solver  of whole's matrix; may keep a factor of an earlier one, and keeps this one's.
double determined_parameters(ObjectiveFunction& image, ObjectiveFunction& whole,
                             const Eigen::VectorXd& phi, const NullSpace& null_space,
                             DampedSolver& solver);

}  // namespace crease
