#include "Registration/Elastic/ImageImprovement.h"

#include <cmath>

#include "Images/CubicBSplineInterpolator.h"
#include "Images/IntensityRange.h"
#include "Metrics/SumOfSquaredDifferences.h"
#include "Registration/Elastic/DisplacementSamples.h"
#include "Registration/ImageTerm.h"
#include "Registration/SamplesInside.h"

namespace crease {
namespace {

constexpr double kRounding = 1e-11;  // of squared intensities, in single precision

}  // namespace

struct ImageImprovement::State {
  std::shared_ptr<const BoundGrid<2>> grid;
  MetricInput<2> input;
  double before = 0;  // half the integral of squared differences
  bool equal = false;

  double difference(std::shared_ptr<const Interpolator<2>> moving, const ControlPoints<2>& phi,
                    const AffineMap<2>& affine) const {
    MetricInput<2> seen = input;
    seen.moving = std::move(moving);
    ImageTerm<2> term(grid, std::make_shared<SumOfSquaredDifferences<2>>(std::move(seen)), affine);
    return term.evaluate(phi, 1, nullptr, nullptr);
  }
};

ImageImprovement::ImageImprovement(Image<float, 2> fixed, const Image<float, 2>& moving,
                                   const Mask<2>* mask, std::shared_ptr<const BoundGrid<2>> grid)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.grid = std::move(grid);
  const double unit = intensity_unit(fixed, mask);
  s.input.weights.assign(fixed.values().size(), 1.0f);
  for (std::size_t i = 0; mask != nullptr && i < s.input.weights.size(); ++i) {
    if (mask->values()[i] == 0) s.input.weights[i] = 0;
  }
  keep_samples_in_domain(*s.grid, s.input.weights);
  double measure = 0;
  for (float weight : s.input.weights) measure += weight;
  measure *= fixed.raster().sample_volume();
  s.input.fixed = std::move(fixed);
  s.input.moving = std::make_shared<CubicBSplineInterpolator<2>>(moving);
  s.before =
      s.difference(s.input.moving, ControlPoints<2>::Zero(2, s.grid->num_control_points()), {});
  s.equal = s.before <= kRounding * unit * unit * measure;
}

ImageImprovement::~ImageImprovement() = default;

bool ImageImprovement::equal() const { return state_->equal; }

std::optional<double> ImageImprovement::percent(const SplineTransform<2>& deformation,
                                                const SplineTransform<2>* refinement) const {
  const State& s = *state_;
  if (s.equal) return std::nullopt;
  double after = 0;
  if (refinement == nullptr) {
    after = s.difference(s.input.moving, deformation.control_points(), deformation.affine());
  } else {
    auto samples = sample_displacement(deformation, *s.grid);
    after = s.difference(
        std::make_shared<DisplacedInterpolator<2>>(s.input.moving, std::move(samples.components)),
        refinement->control_points(), refinement->affine());
  }
  return 100 * (s.before - after) / s.before;
}

}  // namespace crease
