#pragma once

#include <optional>
#include <vector>

#include "Registration/Registration.h"

namespace crease {

/// What a Registration is composed of, with the defaults of what was not set.
template <int Dim>
struct RegistrationParts {
  std::optional<Image<float, Dim>> fixed, moving;
  std::optional<Mask<Dim>> fixed_mask, moving_mask;
  InterpolationKind interpolation = InterpolationKind::kCubic;
  AlignmentOptions alignment;
  std::optional<AffineMap<Dim>> initial;
  std::shared_ptr<const SplineTransform<Dim>> start;  ///< null: found by the run
  std::shared_ptr<const SplineBasis<Dim>> basis;
  MetricFactory<Dim> metric = ssd<Dim>();
  double image_weight = 1;
  /// An energy to be made, and its weight.
  struct WeightedFactory {
    std::string name;
    double weight = 1;
    EnergyFactory<Dim> factory;
  };
  std::vector<WeightedFactory> energies;
  Landmarks<Dim> landmarks;
  LandmarkOptions landmark_options;
  NullSpaceKind null_space = NullSpaceKind::kElimination;
  std::shared_ptr<const Optimizer> optimizer;  ///< null: Gauss-Newton, tuned per level
  Schedule schedule;
  bool look_for_finer_places = false;

  bool has_images() const { return fixed.has_value() && image_weight > 0; }
  const Mask<Dim>* fixed_mask_pointer() const { return fixed_mask ? &*fixed_mask : nullptr; }
  const Mask<Dim>* moving_mask_pointer() const { return moving_mask ? &*moving_mask : nullptr; }
};

}  // namespace crease
