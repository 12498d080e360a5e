#include <algorithm>
#include <cmath>

#include "Metrics/MetricSum.h"
#include "Metrics/TargetDisplacement.h"
#include "Registration/OpticalFlow.h"
#include "Registration/RegistrationRun.h"
#include "Registration/SmoothingEnergy.h"
#include "Registration/StartingPoint.h"

// Where a run starts from.

namespace crease {
namespace {

constexpr int kLargestFlowImage = 1200;  // pixels: larger images give their flow at half the size

}  // namespace

/// Those whose metrics expect similar intensities.
template <int Dim>
std::vector<std::size_t> RegistrationRun<Dim>::similar_channels() const {
  std::vector<std::size_t> similar;
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const ImageLevel<Dim>& coarsest = channels_[c].levels.front();
    const auto metric = channels_[c].metric(metric_input(coarsest, coarsest.weights));
    if (channels_[c].weight > 0 && metric->expects_similar_intensities()) similar.push_back(c);
  }
  return similar;
}

/// Weighted least squares to a dense optical flow of each channel, smooth and rigid as the energies ask for, within the
/// constraints.
template <int Dim>
typename RegistrationRun<Dim>::Phi RegistrationRun<Dim>::fitted_to_flow(
    const Phi& near, const std::vector<std::size_t>& similar) {
  if constexpr (Dim == 2) {
    std::size_t l = num_levels_ - 1;
    const auto width = [&] { return std::ranges::max(levels_[l].grid->raster().size); };
    while (l > 0 && width() > kLargestFlowImage) --l;
    std::vector<MetricSum<2>::Channel> targets;
    for (std::size_t c : similar) {
      const ImageLevel<2>& image = channels_[c].levels[l];
      const FlowField flow = optical_flow(image.fixed, image.weights, *image.moving, affine_);
      targets.push_back(
          {std::make_shared<TargetDisplacement<2>>(flow.raster, flow.displacement, flow.weights),
           channels_[c].weight});
    }
    ImageTerm<2> fit(levels_[l].grid, std::make_shared<MetricSum<2>>(std::move(targets)), affine_);
    const double pixel = compared_.front().fixed.raster().spacing.minCoeff();
    auto energies = energies_;
    for (auto& energy : energies) {
      energy.weight = energy.name == kBendingName   ? 10 * std::pow(pixel, 4)
                      : energy.name == kElasticName ? 4 * pixel * pixel
                                                    : 100 * pixel * pixel;
    }
    return StartingPoint<2>(pattern_, *null_space_, energies).fitted_to(fit, near);
  }
  return near;
}

template <int Dim>
std::vector<typename RegistrationRun<Dim>::Phi> RegistrationRun<Dim>::starts() {
  std::vector<Phi> candidates;
  if (parts_.start != nullptr) {
    const SplineTransform<Dim>& map = *parts_.start;
    return {StartingPoint<Dim>(pattern_, *null_space_, energies_)
                .nearest_to(*parts_.basis, [&](const Point<Dim>& x) -> Vector<Dim> {
                  return map.map(x) - affine_(x);
                })};
  }
  const bool pulled = null_space_->rank() > 0 || energies_.size() > parts_.energies.size();
  candidates.push_back(pulled ? StartingPoint<Dim>(pattern_, *null_space_, energies_).smoothest()
                              : Phi::Zero(null_space_->full_size()));
  if (Dim == 2 && parts_.schedule.optical_flow) {
    const auto similar = similar_channels();
    if (!similar.empty()) candidates.push_back(fitted_to_flow(candidates.front(), similar));
  }
  return candidates;
}

#define CREASE_INSTANTIATE(Dim)                                                                   \
  template std::vector<std::size_t> RegistrationRun<Dim>::similar_channels() const;               \
  template Eigen::VectorXd RegistrationRun<Dim>::fitted_to_flow(const Eigen::VectorXd&,           \
                                                                const std::vector<std::size_t>&); \
  template std::vector<Eigen::VectorXd> RegistrationRun<Dim>::starts();
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease
