#pragma once

#include <optional>
#include <vector>

#include "Registration/Registration.h"

namespace crease {

/// What a Registration is composed of, with the defaults of what was not set.
template <int Dim>
struct RegistrationParts {
  Channel<Dim> first;  ///< empty images: none
  std::vector<Channel<Dim>> further;
  InterpolationKind interpolation = InterpolationKind::kCubic;
  AlignmentOptions alignment;
  std::optional<AffineMap<Dim>> initial;
  std::shared_ptr<const SplineTransform<Dim>> start;  ///< null: found by the run
  std::shared_ptr<const SplineBasis<Dim>> basis;
  TransformFactory<Dim> transform;  ///< null: a spline on the basis
  TransformOptions transform_options;
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
  OptimizerKind optimizer_kind = OptimizerKind::kGaussNewton;
  std::shared_ptr<const Optimizer> optimizer;  ///< null: of the kind, tuned per level
  Schedule schedule;
  bool look_for_finer_places = false;

  bool has_images() const { return !first.fixed.empty() && image_weight > 0; }
  std::vector<ChannelView<Dim>> channels() const {
    std::vector<ChannelView<Dim>> all = views(std::span(&first, 1));
    for (auto& view : views(std::span(further))) all.push_back(std::move(view));
    return all;
  }
};

}  // namespace crease
