#include "Registration/Registration.h"

#include <cmath>

#include "Core/Error.h"
#include "Images/ImageFile.h"
#include "Registration/RegistrationParts.h"
#include "Registration/RegistrationRun.h"
#include "Registration/TransformRun.h"
#include "Transforms/Energies/BendingEnergy.h"
#include "Transforms/Energies/RigidityEnergy.h"
#include "Transforms/Splines/CoveringCentres.h"

namespace crease {

template <int Dim>
EnergyFactory<Dim> bending(WeightField<Dim> rigid) {
  return [rigid](const SplineBasis<Dim>& basis, const AffineMap<Dim>&) {
    return std::make_shared<BendingEnergy<Dim>>(basis, rigid);
  };
}

template <int Dim>
EnergyFactory<Dim> rigidity(WeightField<Dim> rigid) {
  return [rigid](const SplineBasis<Dim>& basis, const AffineMap<Dim>& affine) {
    return std::make_shared<RigidityEnergy<Dim>>(basis, rigid, affine);
  };
}

template <int Dim>
TransformFactory<Dim> cauchy_navier(const Raster<Dim>& raster, double length,
                                    const std::vector<Point<Dim>>& landmarks,
                                    double poisson_ratio) {
  const ControlPoints<Dim> centres = covering_centres<Dim>(raster, length, landmarks);
  return [centres, poisson_ratio](const AffineMap<Dim>& affine) {
    return std::make_unique<CauchyNavierTransform<Dim>>(centres, poisson_ratio, affine);
  };
}

template <int Dim>
Registration<Dim>::Registration() : parts_(std::make_shared<RegistrationParts<Dim>>()) {}

template <int Dim>
Registration<Dim>::Registration(Image<float, Dim> fixed, Image<float, Dim> moving)
    : Registration() {
  if (fixed.empty() || moving.empty()) {
    throw InvalidInput(
        message("registration: the ", fixed.empty() ? "fixed" : "moving", " image is empty"));
  }
  check_finite(fixed, "registration: the fixed image");
  check_finite(moving, "registration: the moving image");
  parts_->first.fixed = std::move(fixed);
  parts_->first.moving = std::move(moving);
}

template <int Dim>
Registration<Dim>& Registration<Dim>::fixed_mask(Mask<Dim> mask) {
  parts_->first.fixed_mask = std::move(mask);
  return *this;
}

template <int Dim>
Registration<Dim>& Registration<Dim>::moving_mask(Mask<Dim> mask) {
  parts_->first.moving_mask = std::move(mask);
  return *this;
}

template <int Dim>
Registration<Dim>& Registration<Dim>::interpolation(InterpolationKind kind) {
  parts_->interpolation = kind;
  return *this;
}

template <int Dim>
Registration<Dim>& Registration<Dim>::alignment(AlignmentOptions options) {
  parts_->alignment = options;
  parts_->initial.reset();
  return *this;
}

template <int Dim>
Registration<Dim>& Registration<Dim>::initial(AffineMap<Dim> map) {
  if (!map.finite()) throw InvalidInput("registration: the initial map is not finite");
  parts_->initial = map;
  return *this;
}

template <int Dim>
Registration<Dim>& Registration<Dim>::go_on_from(const RegistrationResult<Dim>& earlier) {
  parts_->start = earlier.spline();
  parts_->initial = earlier.initial;
  for (auto& energy : parts_->energies) {
    const auto used = earlier.weights.find(energy.name);
    if (used != earlier.weights.end()) energy.weight = used->second;
  }
  const auto landmarks = earlier.weights.find("landmarks");
  if (landmarks != earlier.weights.end()) parts_->landmark_options.weight = landmarks->second;
  parts_->schedule.levels = 1;
  parts_->schedule.adapt_weights = false;
  return *this;
}

template <int Dim>
Registration<Dim>& Registration<Dim>::look_for_finer_places(bool look) {
  parts_->look_for_finer_places = look;
  return *this;
}

template <int Dim>
Registration<Dim>& Registration<Dim>::basis(std::shared_ptr<const SplineBasis<Dim>> basis) {
  parts_->basis = std::move(basis);
  return *this;
}

template <int Dim>
Registration<Dim>& Registration<Dim>::transform(TransformFactory<Dim> factory,
                                                TransformOptions options) {
  if (!(options.detail_mm > 0) || !std::isfinite(options.detail_mm) || !(options.roughness >= 0) ||
      !std::isfinite(options.roughness)) {
    throw InvalidInput(message("registration: a transform's detail is ", options.detail_mm,
                               " mm and the weight of its roughness ", options.roughness,
                               "; both must be finite, the first positive, the second 0 or more"));
  }
  parts_->transform = std::move(factory);
  parts_->transform_options = options;
  return *this;
}

template <int Dim>
Registration<Dim>& Registration<Dim>::metric(MetricFactory<Dim> factory, double weight) {
  if (!(weight >= 0) || !std::isfinite(weight)) {
    throw InvalidInput(message("registration: channel 1 has the weight ", weight,
                               "; it must be a finite number, 0 or more"));
  }
  parts_->first.metric = std::move(factory);
  parts_->first.weight = weight;
  return *this;
}

template <int Dim>
Registration<Dim>& Registration<Dim>::channel(Channel<Dim> channel) {
  if (parts_->first.fixed.empty()) {
    throw InvalidInput("registration: a further channel needs a first pair of images");
  }
  check_channel(channel, parts_->first.fixed.raster(), parts_->further.size() + 2);
  parts_->further.push_back(std::move(channel));
  return *this;
}

template <int Dim>
Registration<Dim>& Registration<Dim>::image_weight(double alpha) {
  if (!(alpha >= 0) || !std::isfinite(alpha)) {
    throw InvalidInput(message("registration: the image weight alpha is ", alpha,
                               "; it must be a finite number, 0 or more"));
  }
  parts_->image_weight = alpha;
  return *this;
}

template <int Dim>
Registration<Dim>& Registration<Dim>::energy(std::string name, double weight,
                                             EnergyFactory<Dim> factory) {
  if (!(weight >= 0) || !std::isfinite(weight)) {
    throw InvalidInput(message("registration: the weight of the ", name, " energy is ", weight,
                               "; it must be a finite number, 0 or more"));
  }
  if (factory == nullptr) throw InvalidInput(message("registration: no ", name, " energy given"));
  parts_->energies.push_back({std::move(name), weight, std::move(factory)});
  return *this;
}

template <int Dim>
Registration<Dim>& Registration<Dim>::landmarks(Landmarks<Dim> landmarks,
                                                const LandmarkOptions& options) {
  parts_->landmarks = std::move(landmarks);
  parts_->landmark_options = options;
  return *this;
}

template <int Dim>
Registration<Dim>& Registration<Dim>::null_space(NullSpaceKind kind) {
  parts_->null_space = kind;
  return *this;
}

template <int Dim>
Registration<Dim>& Registration<Dim>::optimizer(OptimizerKind kind) {
  if (kind == OptimizerKind::kNelderMead) {
    throw InvalidInput(
        "registration: Nelder-Mead is for few unknowns, rigid and affine maps; a spline needs an "
        "optimizer with gradients");
  }
  parts_->optimizer_kind = kind;
  parts_->optimizer = nullptr;
  return *this;
}

template <int Dim>
// NOLINTNEXTLINE(performance-unnecessary-value-param): moved
Registration<Dim>& Registration<Dim>::optimizer(std::shared_ptr<const Optimizer> optimizer) {
  parts_->optimizer = std::move(optimizer);
  return *this;
}

template <int Dim>
Registration<Dim>& Registration<Dim>::schedule(Schedule schedule) {
  if (schedule.levels < 1 || schedule.levels > 12) {
    throw InvalidInput(
        message("registration: ", schedule.levels, " levels asked for; the range is 1 to 12"));
  }
  if (!(schedule.level_bending > 0)) {
    throw InvalidInput("registration: level_bending must be positive");
  }
  if (!(schedule.sample_fraction > 0 && schedule.sample_fraction <= 1)) {
    throw InvalidInput(message("registration: a sample_fraction of ", schedule.sample_fraction,
                               "; give a share above 0 and at most 1"));
  }
  parts_->schedule = schedule;
  return *this;
}

template <int Dim>
RegistrationResult<Dim> Registration<Dim>::run(const RegistrationCallback& progress) const {
  if (parts_->has_images()) {
    for (const ChannelView<Dim>& view : parts_->channels()) {
      require_contrast(*view.fixed, view.fixed_mask, "fixed");
      require_contrast(*view.moving, view.moving_mask, "moving");
      if (parts_->initial) {
        require_overlap(view.fixed->raster(), view.moving->raster(), *parts_->initial);
      }
    }
  }
  if (parts_->transform) return TransformRun<Dim>(*parts_, progress).execute();
  return RegistrationRun<Dim>(*parts_, progress).execute();
}

template EnergyFactory<2> bending<2>(WeightField<2>);
template EnergyFactory<3> bending<3>(WeightField<3>);
template EnergyFactory<2> rigidity<2>(WeightField<2>);
template EnergyFactory<3> rigidity<3>(WeightField<3>);
template TransformFactory<2> cauchy_navier<2>(const Raster<2>&, double,
                                              const std::vector<Point<2>>&, double);
template TransformFactory<3> cauchy_navier<3>(const Raster<3>&, double,
                                              const std::vector<Point<3>>&, double);
template class Registration<2>;
template class Registration<3>;

}  // namespace crease
