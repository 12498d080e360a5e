#include "Transforms/Energies/LandmarkEnergy.h"

#include <cmath>

#include "Core/Error.h"

namespace crease {

template <int Dim>
LandmarkEnergy<Dim>::LandmarkEnergy(const SplineBasis<Dim>& basis, const AffineMap<Dim>& affine,
                                    std::span<const Point<Dim>> fixed,
                                    std::span<const Point<Dim>> moving,
                                    std::span<const double> sigma_mm) {
  if (fixed.size() != moving.size() || fixed.size() != sigma_mm.size()) {
    throw InvalidInput(message("LandmarkEnergy: ", fixed.size(), " fixed landmarks, ",
                               moving.size(), " moving landmarks and ", sigma_mm.size(),
                               " uncertainties; as many of each are needed."));
  }
  for (std::size_t j = 0; j < fixed.size(); ++j) {
    if (!fixed[j].allFinite() || !moving[j].allFinite() || !std::isfinite(sigma_mm[j]) ||
        !(sigma_mm[j] > 0)) {
      throw InvalidInput(message("LandmarkEnergy: landmark ", j, " at (", fixed[j].transpose(),
                                 ") mm to (", moving[j].transpose(), ") mm has the uncertainty ",
                                 sigma_mm[j], " mm; all must be finite and it positive."));
    }
    if (!basis.contains(fixed[j])) {
      throw InvalidInput(message(
          "LandmarkEnergy: the fixed landmark ", j, " at (", fixed[j].transpose(), ") mm lies ",
          (basis.nearest_point(fixed[j]) - fixed[j]).norm(), " mm outside the domain."));
    }
    landmarks_.push_back(
        {basis.evaluate(fixed[j]), moving[j] - affine(fixed[j]), 1 / (sigma_mm[j] * sigma_mm[j])});
  }
}

template <int Dim>
double LandmarkEnergy<Dim>::evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                                     ControlPoints<Dim>* gradient,
                                     BlockHessian<Dim>* hessian) const {
  double energy = 0;
  for (const Landmark& landmark : landmarks_) {
    const auto& numbers = landmark.basis.control_points;
    const auto& values = landmark.basis.values;
    Vector<Dim> residual = -landmark.wanted;
    for (std::size_t n = 0; n < numbers.size(); ++n) residual += values[n] * phi.col(numbers[n]);
    energy += 0.5 * landmark.weight * residual.squaredNorm();
    for (std::size_t n = 0; n < numbers.size(); ++n) {
      const double factor = scale * landmark.weight * values[n];
      if (gradient) gradient->col(numbers[n]) += factor * residual;
      for (std::size_t m = 0; hessian && m <= n; ++m) {
        hessian->add(numbers[n], numbers[m], factor * values[m] * Matrix<Dim>::Identity());
      }
    }
  }
  return energy;
}

template <int Dim>
void LandmarkEnergy<Dim>::add_stiffness(double scale, const HessianPattern& pattern,
                                        std::span<double> stiffness) const {
  for (const Landmark& landmark : landmarks_) {
    const auto& numbers = landmark.basis.control_points;
    const auto& values = landmark.basis.values;
    for (std::size_t n = 0; n < numbers.size(); ++n) {
      for (std::size_t m = 0; m <= n; ++m) {
        stiffness[pattern.slot(numbers[n], numbers[m])] +=
            scale * landmark.weight * values[n] * values[m];
      }
    }
  }
}

template <int Dim>
bool LandmarkEnergy<Dim>::add_pull(const Eigen::Ref<const ControlPoints<Dim>>&, double scale,
                                   ControlPoints<Dim>& pull) const {
  for (const Landmark& landmark : landmarks_) {
    const auto& numbers = landmark.basis.control_points;
    for (std::size_t n = 0; n < numbers.size(); ++n) {
      pull.col(numbers[n]) += scale * landmark.weight * landmark.basis.values[n] * landmark.wanted;
    }
  }
  return false;
}

template class LandmarkEnergy<2>;
template class LandmarkEnergy<3>;

}  // namespace crease
