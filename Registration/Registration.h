#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "Images/Image.h"
#include "Images/MakeInterpolator.h"
#include "Optimizers/MakeOptimizer.h"
#include "Optimizers/NullSpace.h"
#include "Optimizers/Optimizer.h"
#include "Registration/Channel.h"
#include "Registration/FinerPlaces.h"
#include "Registration/InitialAlignment.h"
#include "Registration/LandmarkConstraints.h"
#include "Registration/Landmarks.h"
#include "Registration/MetricFactories.h"
#include "Registration/Progress.h"
#include "Registration/RegistrationObjective.h"
#include "Transforms/CauchyNavierTransform.h"
#include "Transforms/Energies/WeightField.h"
#include "Transforms/SplineTransform.h"

namespace crease {

template <int Dim>
struct RegistrationParts;

/// Makes an energy when the basis and the affine map A of the run are known.
template <int Dim>
using EnergyFactory = std::function<std::shared_ptr<const Energy<Dim>>(const SplineBasis<Dim>&,
                                                                       const AffineMap<Dim>&)>;

/// Bending of the soft tissue, weight (1 - w)^2 (BendingEnergy).
template <int Dim>
EnergyFactory<Dim> bending(WeightField<Dim> rigid = nullptr);

/// Rigidity of the bodies, weight w (RigidityEnergy); the default w is 1 in regions above 0.
template <int Dim>
EnergyFactory<Dim> rigidity(WeightField<Dim> rigid = body_weights<Dim>());

/// Makes the transform of a registration, at rest T = A, when the affine map A is known.
template <int Dim>
using TransformFactory =
    std::function<std::unique_ptr<Transform<Dim>>(const AffineMap<Dim>& affine)>;

/// How a transform that is no spline on a basis is registered.
struct TransformOptions {
  /// mm: the distance over which the transform varies, as that of its centres; samples are mapped through
  /// a lattice of a quarter of it (TransformLattice).
  double detail_mm = 16;
  double roughness = 0;  ///< weight of the transform's own roughness (Transform::roughness_matrix)
};

/// Elastic body splines (CauchyNavierTransform) with covering_centres(): a lattice about `length` mm apart over
/// the raster, and the landmarks.
template <int Dim>
TransformFactory<Dim> cauchy_navier(const Raster<Dim>& raster, double length,
                                    const std::vector<Point<Dim>>& landmarks = {},
                                    double poisson_ratio = kPoissonRatio);

/// A weight of roughness beside images whose intensities are normalised, mm^(Dim + 1), for centres `length` mm
/// apart: 1e-4 length^(Dim + 1), from which Schedule::adapt_weights starts.
template <int Dim>
double default_roughness_weight(double length) {
  return 1e-4 * std::pow(length, Dim + 1);
}

/// From coarse to fine.
struct Schedule {
  int levels = 3;  ///< image pyramid, a factor of 2 each; fewer for small images
  /// The energy named "bending", or a transform's roughness, weighs this much more per coarser level; the one
  /// named "elastic" by the square root of it.
  double level_bending = 4;
  /// Try a start fitted to dense optical flow (2D, metrics that expect similar intensities).
  bool optical_flow = true;
  /// Weighs the energy named "bending" by the noise and the roughness that the levels show
  /// (BendingBalance), from its weight on, and more where the finest map folds; and soft landmarks by
  /// the noise, so that their uncertainty in mm is what it says beside the image's.
  bool adapt_weights = false;
  /// Go on from a map that folds until one is certified not to (Unfolding).
  bool require_invertible = false;
  /// Of the rows of samples at all levels but the finest: so many are looked at, chosen by the seed; 0 to 1.
  double sample_fraction = 1;
  std::uint64_t seed = 1;
  bool smooth_finest = true;  ///< low-pass [1 2 1]/4 at the finest level, against noise
};

/// What happened at one level.
struct LevelReport {
  int shrink = 1;
  int iterations = 0;
  int evaluations = 0;
  int factorizations = 0;
  std::string stopped_because;
  std::map<std::string, double> terms_before, terms_after;  ///< unweighted, "image" the metric's
  std::vector<double> energy_history;  ///< weighted sum per iteration, the level's start included
  /// Its weighted terms by name; without entries where the optimizer's last evaluation was another point.
  std::vector<std::map<std::string, double>> term_history;
};

/// How a map was made invertible where that was asked for and it folded.
struct UnfoldingReport {
  int rounds = 0;            ///< minimisations with an energy against folds
  double weight = 0;         ///< of that energy in the last one
  double share = 1;          ///< of the way from a certified map that was kept
  double folded_metric = 0;  ///< of the map that folded
  bool certified = false;
};

/// The map, and what is known about it and the way to it.
template <int Dim>
struct RegistrationResult {
  std::shared_ptr<const Transform<Dim>>
      transform;           ///< SplineTransform unless another was asked for
  AffineMap<Dim> initial;  ///< A: what the alignment found
  AlignmentReport alignment;
  std::map<std::string, double> energies;  ///< unweighted, at the finest level
  std::map<std::string, double> weights;   ///< of the energies, as used there
  double metric_before = 0;                ///< finest level, at A
  double metric_after = 0;
  std::vector<ChannelReport> channels;  ///< of the metric, likewise
  std::vector<LevelReport> levels;
  std::optional<UnfoldingReport> unfolding;  ///< where it was needed
  std::vector<double> landmark_errors_mm;
  Eigen::Index free_parameters = 0;
  std::string stopped_because;
  bool converged = true;  ///< false: stopped by a limit or cancelled
  bool improved = true;
  double cost = 0;                            ///< weighted sum of all terms, at the finest level
  std::vector<FinerPlace<Dim>> finer_places;  ///< where asked for
  /// The transform when it is a spline on a basis; null when another was asked for.
  std::shared_ptr<const SplineTransform<Dim>> spline() const {
    return std::dynamic_pointer_cast<const SplineTransform<Dim>>(transform);
  }
  std::map<std::string, double> timings_s;  ///< "alignment", "binding", "start", "optimization"
  std::vector<std::string> warnings;
};

/// A registration, composed: two images, a spline basis for u in T(x) = A(x) + u(x), a metric, energies
/// with weights, constraints, an optimizer and a schedule. Each part has a default; whatever is set
/// replaces it. Any basis works with any metric, energies, constraints and optimizer.
///
///     Registration<2> registration(fixed, moving);
///     registration.basis(basis).energy("bending", gamma, bending).landmarks(pairs);
///     const auto result = registration.run();
///
/// Intensities are divided by the fixed image's 1..99 % range in its mask, so that weights do not
/// depend on units. Source: dissertation, chapter 3.
template <int Dim>
class Registration {
 public:
  /// @throws InvalidInput when an image is empty or holds values that are not finite.
  Registration(Image<float, Dim> fixed, Image<float, Dim> moving);
  /// A registration by landmarks and energies alone, without images.
  Registration();

  /// Samples count where the mask is 1.
  Registration& fixed_mask(Mask<Dim> mask);
  /// Points of the moving image count where the mask is 1, with a soft edge.
  Registration& moving_mask(Mask<Dim> mask);
  /// Between the pixels of the moving image; the default is cubic.
  Registration& interpolation(InterpolationKind kind);
  /// How A is found; the default starts from the centres of mass and stays there (no search).
  Registration& alignment(AlignmentOptions options);
  /// A is given.
  Registration& initial(AffineMap<Dim> map);
  /// Goes on from an earlier result, in another basis: its map is carried into that basis (the nearest one
  /// in the mean square that meets the landmarks), weights are as they were used there, and the finest level
  /// alone is run.
  Registration& go_on_from(const RegistrationResult<Dim>& earlier);
  /// Fills RegistrationResult::finer_places at the end.
  Registration& look_for_finer_places(bool look = true);
  /// Of u; needed, unless another transform is given.
  Registration& basis(std::shared_ptr<const SplineBasis<Dim>> basis);
  /// In place of a spline on a basis: any transform, by any metric and optimizer. Its own roughness takes the
  /// place of energies; Schedule::adapt_weights weighs it as bending, but does not watch for folds. Exact
  /// landmarks need a transform that is linear in its parameters. @throws InvalidInput when the options are not positive numbers.
  Registration& transform(TransformFactory<Dim> factory, TransformOptions options);
  /// How images are compared; the default is ssd(). The weight is that of the first channel among several.
  /// @throws InvalidInput for a weight that is negative or not finite.
  Registration& metric(MetricFactory<Dim> factory, double weight = 1);
  /// Compares two more images at once, with a metric and a weight of their own: E_I = sum_c w_c E_c. All move
  /// alike. Optical flow and normalisation work on each channel; the alignment starts from the first.
  /// @throws InvalidInput as check_channel(), or when there is no first pair of images.
  Registration& channel(Channel<Dim> channel);
  /// Of the metric, 0 or more; the default is 1. @throws InvalidInput for other values.
  Registration& image_weight(double alpha);
  /// Adds an energy; its weight is 0 or more. The schedule knows the name "bending".
  Registration& energy(std::string name, double weight, EnergyFactory<Dim> factory);
  /// Pairs to be met, exactly unless the options or a sigma say otherwise.
  Registration& landmarks(Landmarks<Dim> landmarks, const LandmarkOptions& options = {});
  /// How exact landmarks are eliminated; the results are the same.
  Registration& null_space(NullSpaceKind kind);
  /// The kind of optimizer, with stopping rules that suit the level; the default is Gauss-Newton.
  /// @throws InvalidInput for Nelder-Mead, which is for few unknowns.
  Registration& optimizer(OptimizerKind kind);
  /// An optimizer with rules of its own, the same at every level.
  Registration& optimizer(std::shared_ptr<const Optimizer> optimizer);
  /// @throws InvalidInput for levels outside 1 to 12, a factor that is not positive, or a fraction that is
  /// not above 0 or is above 1.
  Registration& schedule(Schedule schedule);

  /// @throws InvalidInput, SolverError; see the parts.
  RegistrationResult<Dim> run(const RegistrationCallback& progress = {}) const;

 private:
  std::shared_ptr<RegistrationParts<Dim>> parts_;
};

extern template class Registration<2>;
extern template class Registration<3>;

}  // namespace crease
