#include "Registration/Unfolding.h"

#include <algorithm>
#include <cmath>

namespace crease {
namespace {

constexpr double kThresholdRise = 1.5;  // of det below which it costs, where that is not enough ...
constexpr double kMostThreshold = 0.6;  // ... up to this
constexpr double kWatched = 0.25;       // patches whose bound is below it are watched
constexpr double kFirstShare = 0.1;  // of the curvature that the energy against folds adds at first
constexpr double kRise = 10;         // of its weight per round
constexpr int kMostRounds = 8;       // of rising weights
constexpr int kMostIdleRounds = 3;
constexpr double kProgress = 0.1;     // of the least determinant in a round that is not idle
constexpr int kMostRetreatTests = 8;  // of the way back, by halving

template <int Dim>
Eigen::Map<const ControlPoints<Dim>> points_of(const Eigen::VectorXd& phi) {
  return {phi.data(), Dim, phi.size() / Dim};
}

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

/// Such that the energy adds a share of the curvature that the cost has on the control points it holds.
template <int Dim>
double Unfolding<Dim>::first_weight(const Phi& phi) const {
  Eigen::VectorXd of_cost;
  costs_.value(phi, &of_cost);
  BlockHessian<Dim> hessian(basis_->pattern());
  folding_->evaluate(points_of<Dim>(phi), 1, nullptr, &hessian);
  const Eigen::VectorXd of_folding = hessian.to_sparse().diagonal();
  double cost = 0, folding = 0;
  for (Eigen::Index i = 0; i < of_folding.size(); ++i) {
    if (!(of_folding[i] > 0)) continue;
    cost += of_cost[i];
    folding += of_folding[i];
  }
  return cost > 0 ? kFirstShare * cost / folding : 1.0;
}

/// Minimises with a rising weight until the certificate is there, or three rounds in a row bring it no nearer.
template <int Dim>
void Unfolding<Dim>::press(const Minimise& minimise, UnfoldingResult<Dim>& result) {
  watch(result.certificate);
  double weight = first_weight(result.phi);
  int fewest = result.certificate.num_failing, idle = 0;
  double lowest = folding_->least_determinant(points_of<Dim>(result.phi));
  for (int round = 0; round < kMostRounds && idle < kMostIdleRounds; ++round) {
    result.phi = minimise(folding_, weight, result.phi);
    result.certificate = certify(result.phi);
    result.folding_weight = weight;
    ++result.rounds;
    if (result.certificate.certified()) return;
    watch(result.certificate);
    weight *= kRise;
    const double least = folding_->least_determinant(points_of<Dim>(result.phi));
    const bool nearer =
        result.certificate.num_failing < fewest || least > lowest + kProgress * std::abs(lowest);
    idle = nearer ? 0 : idle + 1;
    fewest = std::min(fewest, result.certificate.num_failing);
    lowest = std::max(lowest, least);
    if (least <= 0) continue;
    // Folds between the energy's points, at the border above all, give way when the points stay farther away.
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
  if (!certificate.certified() ||
      costs_.value(better, nullptr) >= costs_.value(result.phi, nullptr))
    return;
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
  press(costs_.with_images, result);
  if (done(result)) return result;
  UnfoldingResult<Dim> base;
  base.phi = smoothest;
  base.certificate = certify(smoothest);
  if (!base.certificate.certified()) press(costs_.without_images, base);
  result.rounds += base.rounds;
  if (base.certificate.certified()) {
    retreat(base.phi, result);
    improve(result);
  } else if (certify(phi).num_failing < result.certificate.num_failing) {
    result.phi = phi;
    result.certificate = certify(phi);
  }
  return result;
}

template class Unfolding<2>;
template class Unfolding<3>;

}  // namespace crease
