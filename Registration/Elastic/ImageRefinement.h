#pragma once

#include <optional>
#include <string>
#include <vector>

#include "Images/Image.h"
#include "Images/MakeInterpolator.h"
#include "Optimizers/Optimizer.h"
#include "Registration/MetricFactories.h"
#include "Registration/Progress.h"
#include "Transforms/BoundGrid.h"
#include "Transforms/Energies/ElasticMaterial.h"
#include "Transforms/SplineTransform.h"

namespace crease {

/// How J is minimised.
enum class RefinementMethod {
  kGaussNewton,  ///< a few steps: the default
  kDamped        ///< DampedIteration, as the dissertation has it: hundreds of steps
};

/// What is compared, what it weighs, and when to stop.
struct ImageRefinementOptions {
  ElasticMaterial material;
  MetricFactory<2> metric = ssd<2>();
  InterpolationKind interpolation = InterpolationKind::kCubic;
  /// alpha = c trace(N^T M N) / trace(N^T D N) at each level, D the metric's Gauss-Newton matrix at v = 0. M's
  /// trace is that of its finest waves, thousands of times stiffer than those in which tissue moves: with c = 1
  /// hardly anything resists the images. On three mammogram phantoms c = 0.1 and more folded, tore or doubled
  /// the errors, 1e-3 folded one, and 1e-4 bettered all without folds.
  double relative_weight = 1e-4;  ///< c
  std::optional<double>
      weight;  ///< alpha itself, for intensities in units of the fixed image's range
  std::vector<Point<2>> pins;  ///< v = 0 there, mm; two at least, or the body can turn
  int levels = 4;              ///< images by 8, 4, 2, 1
  /// Of the Gaussian that smooths both images, mm, coarsest level first; the last holds for all that follow.
  std::vector<double> smoothing_mm = {3, 1.5, 0.75};
  RefinementMethod method = RefinementMethod::kGaussNewton;
  double damped_step = 0.01;        ///< h
  double relative_decrease = 1e-4;  ///< stop when J falls by less in an iteration,
  double step_pixels = 0.02;  ///< or no sample of the level would move farther in a full step,
  int max_iterations = 50;    ///< or after so many
  /// The basis bound to the fixed image's raster, where that was done already.
  std::shared_ptr<const BoundGrid<2>> grid = nullptr;
};

/// What happened at one resolution.
struct RefinementLevel {
  int shrink = 1;
  std::array<int, 2> size{};  ///< pixels
  double smoothing_mm = 0;
  double weight = 0;  ///< alpha
  int iterations = 0, evaluations = 0, factorizations = 0;
  int halvings = 0;  ///< of the damped step
  double metric_before = 0, metric_after = 0, elastic_energy = 0;
  std::vector<IterationRecord> history;  ///< of J
  std::string stopped_because;
  double displacement_error_pixels = 0;  ///< of u* as the metric reads it (DisplacementSamples)
  double setup_s = 0, iterations_s = 0;
};

/// The refinement and how it was found.
struct ImageRefinementResult {
  /// y = x + v(x). T is reached by x -> y + u*(y).
  std::shared_ptr<const SplineTransform<2>> transform;
  std::vector<RefinementLevel> levels;
  bool converged = true;  ///< false: stopped by the iteration limit or cancelled
  std::vector<std::string> warnings;
};

/// Refines a map T*(y) = y + u*(y), found from point pairs, by the images: looks for a small v that minimises
///
///     J(v) = 1/2 a(v, v) + alpha E_I(T' (x + v(x)), R(x)),     T'(y) = T(y + u*(y)),
///
/// a the linear elasticity of the same material, E_I half the integral of squared differences over u*'s domain,
/// or any other metric. The gradient is M V - F(V) with the body force F = -dE_I/dV. T' is evaluated by
/// composing the maps, never by resampling a warped image. From coarse to fine, v carried over.
///
/// What intensities alone can add to well-chosen pairs is little: they draw to the nearest edge, right or not.
/// @param fixed_mask  null: all samples of the domain count.
/// @throws InvalidInput for options out of range, and images that have nothing in common or no structure;
/// SolverError when the damped iteration grows whatever its step.
/// Source: dissertation, (4.9) to (4.14).
ImageRefinementResult refine_by_images(const Image<float, 2>& fixed, const Image<float, 2>& moving,
                                       const Mask<2>* fixed_mask, const SplineTransform<2>& start,
                                       const ImageRefinementOptions& options,
                                       const RegistrationCallback& progress = {});

}  // namespace crease
