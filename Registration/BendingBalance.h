#pragma once

#include <Eigen/Core>

namespace crease {

/// What one level says about the noise of the images and the roughness of the motion.
struct BendingBalance {
  double image_energy = 0;     ///< 1/2 int r^2 over the samples that count, r the residual
  double counted_measure = 0;  ///< their area or volume, mm^Dim
  /// In which the noise of one sample is correlated: its own, times what filters have joined.
  double correlated_measure = 0;
  double bending_energy = 0;  ///< E_S, unweighted
  Eigen::Index free_parameters = 0;

  /// The weight gamma at which bending and noise are in balance: gamma E_S = 1/2 s n, where s is the
  /// residual's power times the measure in which it is correlated, and n the number of parameters that the
  /// images determine, taken as a fixed share of the free ones. Rough motions and clean images ask for
  /// little bending, smooth motions and noisy images for much.
  /// Source: D. J. C. MacKay, "Bayesian Interpolation", Neural Computation 4, 1992, for the form.
  double weight() const;
  /// s, mm^Dim: what 1/2 r^2 per sample stands for in 1/2 int r^2 when it is noise.
  double noise_density() const;
};

}  // namespace crease
