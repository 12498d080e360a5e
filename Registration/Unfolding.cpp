#include "Registration/Unfolding.h"

#include <algorithm>
#include <cmath>

namespace crease {
namespace {

constexpr double kThresholdRise = 1.5;  // of det below which it costs, where that is not enough ...
constexpr double kMostThreshold = 0.6;  // ... up to this
constexpr double kWatched = 0.25;       // patches whose bound is below it are watched
constexpr double kFirstShare = 0.1;     // of the cost that the energy against folds has at first
constexpr double kLeastCost = 1e-3;     // of the smoothest map's, that this refers to at least
constexpr double kLeastFolds = 1e-3;    // per measure of what is watched, that this refers to
constexpr double kRise = 10;            // of its weight per round
constexpr int kMostRounds = 8;          // of rising weights
constexpr int kMostRetreatTests = 8;    // of the way back, by halving

}  // namespace

template <int Dim>
Unfolding<Dim>::Unfolding(std::shared_ptr<const SplineBasis<Dim>> basis,
                          const AffineMap<Dim>& affine, Costs costs)
    : basis_(std::move(basis)), affine_(affine), costs_(std::move(costs)) {}

template <int Dim>
InvertibilityCertificate<Dim> Unfolding<Dim>::certify(const Phi& phi) const {
  SplineTransform<Dim> transform(basis_, affine_);
  transform.set_parameters(phi);
  return certify_invertibility(transform, {.tighten = false});
}

/// The energy sees all patches that were ever low.
template <int Dim>
void Unfolding<Dim>::watch(const InvertibilityCertificate<Dim>& certificate) {
  const auto& bounds = certificate.patch_bounds;
  watched_.resize(bounds.size(), 0);
  bool more = folding_ == nullptr;
  for (std::size_t p = 0; p < bounds.size(); ++p) {
    if (watched_[p] != 0 || bounds[p] >= kWatched) continue;
    watched_[p] = 1;
    more = true;
  }
  if (!more) return;
  folding_ = std::make_shared<const FoldingEnergy<Dim>>(
      *basis_, affine_, FoldingOptions{.threshold = threshold_, .wanted = [this](int, int patch) {
                                         return watched_[patch] != 0;
                                       }});
}

/// Minimises with a rising weight until the certificate is there.
template <int Dim>
void Unfolding<Dim>::press(const Minimise& minimise, double least_cost,
                           UnfoldingResult<Dim>& result) {
  const auto control_points = [&](const Phi& phi) {
    return Eigen::Map<const ControlPoints<Dim>>(phi.data(), Dim, phi.size() / Dim);
  };
  watch(result.certificate);
  const double folds = folding_->evaluate(control_points(result.phi), 1, nullptr, nullptr);
  const double cost = std::max(costs_.value(result.phi), least_cost);
  const double unit = std::max(folds, kLeastFolds * folding_->measure());
  double weight = cost > 0 ? kFirstShare * cost / unit : 1.0;
  for (int round = 0; round < kMostRounds && !result.certificate.certified(); ++round) {
    result.phi = minimise(folding_, weight, result.phi);
    result.certificate = certify(result.phi);
    result.folding_weight = weight;
    ++result.rounds;
    watch(result.certificate);
    weight *= kRise;
    // Folds between the energy's points, at the border above all, give way when the points stay farther away.
    if (folding_->least_determinant(control_points(result.phi)) <= 0) continue;
    threshold_ = std::min(kThresholdRise * threshold_, kMostThreshold);
    folding_ = std::make_shared<const FoldingEnergy<Dim>>(folding_->with_threshold(threshold_));
  }
}

/// The farthest certified map found on the way from a certified one.
template <int Dim>
void Unfolding<Dim>::retreat(const Phi& certified, UnfoldingResult<Dim>& result) const {
  const Phi way = result.phi - certified;
  double low = 0, high = 1;
  for (int test = 0; test < kMostRetreatTests; ++test) {
    const double middle = 0.5 * (low + high);
    (certify(certified + middle * way).certified() ? low : high) = middle;
  }
  result.share = low;
  result.phi = certified + low * way;
  result.certificate = certify(result.phi);
}

/// From a map that does not fold the energy against folds may keep the minimum from folding.
template <int Dim>
void Unfolding<Dim>::improve(UnfoldingResult<Dim>& result) {
  const Phi better = costs_.with_images(folding_, result.folding_weight, result.phi);
  const InvertibilityCertificate<Dim> certificate = certify(better);
  ++result.rounds;
  if (!certificate.certified() || costs_.value(better) >= costs_.value(result.phi)) return;
  result.phi = better;
  result.certificate = certificate;
}

template <int Dim>
UnfoldingResult<Dim> Unfolding<Dim>::run(const Phi& phi, const Phi& smoothest) {
  UnfoldingResult<Dim> result;
  result.phi = phi;
  result.certificate = certify(phi);
  const auto done = [](const UnfoldingResult<Dim>& r) {
    return r.certificate.certified() || r.certificate.verdict == Invertibility::kNotCertifiable;
  };
  if (done(result)) return result;
  const double least_cost = kLeastCost * costs_.value(smoothest);
  press(costs_.with_images, least_cost, result);
  if (done(result)) return result;
  UnfoldingResult<Dim> base;
  base.phi = smoothest;
  base.certificate = certify(smoothest);
  if (!base.certificate.certified()) press(costs_.without_images, least_cost, base);
  result.rounds += base.rounds;
  if (base.certificate.certified()) retreat(base.phi, result);
  if (result.certificate.certified()) improve(result);
  return result;
}

template class Unfolding<2>;
template class Unfolding<3>;

}  // namespace crease
