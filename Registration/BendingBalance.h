#pragma once

#include <optional>
#include <span>

namespace crease {

/// What one level says about the noise of the images and the roughness of the motion.
struct BendingBalance {
  double image_energy = 0;  ///< 1/2 int r^2 over the samples that count, r the residual
  /// Of r, where the metric knows it (Metric::noise_power); nullopt: found from image_energy.
  std::optional<double> noise_power = std::nullopt;
  double counted_measure = 0;  ///< their area or volume, mm^Dim
  /// In which the noise of one sample is correlated: its own, times what filters have joined.
  double correlated_measure = 0;
  double bending_energy = 0;  ///< E_S, unweighted
  /// By the images, of the free ones: determined_parameters().
  double determined_parameters = 0;
  /// s, where several channels have made it; nullopt: found from the above.
  std::optional<double> combined_density = std::nullopt;

  /// The weight gamma at which the motion is as rough as its parameters' noise explains: 2 gamma E_S = s n,
  /// where s is the residual's power, less what n parameters have taken of it, times the measure in which
  /// it is correlated, and n the number of parameters that the images determine. Rough motions and clean
  /// images ask for little bending, smooth motions and noisy images for much. Half as much again is taken:
  /// motions of tissue are smoother than random ones of the same energy.
  /// Source: D. J. C. MacKay, "Bayesian Interpolation", Neural Computation 4, 1992.
  double weight() const;
  /// s, mm^Dim: what 1/2 r^2 per sample stands for in 1/2 int r^2 when it is noise.
  double noise_density() const;
};

/// One balance, without bending, of channels that are compared at once with the weights w_c: the n_c parameters
/// that channel c determines are as noisy as it is, in units of its weight,
///
///     n = sum_c n_c,     s = sum_c w_c s_c n_c / n.
///
/// @param channels  unweighted, but n_c with the weights, so that n is what all determine together.
BendingBalance combined(std::span<const BendingBalance> channels, std::span<const double> weights);

}  // namespace crease
