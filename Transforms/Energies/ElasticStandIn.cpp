// The quadratic stand-in of an elastic energy, from which a minimisation starts.
#include "Transforms/Energies/ElasticEnergy.h"
#include "Transforms/Rotation.h"

namespace crease {
namespace {

/// kappa of the stand-in 1/2 int kappa |F - R|^2.
template <int Dim>
double stand_in_stiffness(const LameParameters& lame) {
  return lame.mu + (lame.lambda + lame.mu) / Dim;
}

/// Weights times kappa at a cell's points.
template <int Dim>
Eigen::VectorXd stand_in_weights(const ElasticPatch<Dim>& patch, std::size_t c) {
  Eigen::VectorXd weights = patch.cells.cells[c].weights;
  const auto& lame = patch.lame[c];
  for (Eigen::Index p = 0; p < weights.size(); ++p) {
    weights[p] *= stand_in_stiffness<Dim>(lame[lame.size() == 1 ? 0 : p]);
  }
  return weights;
}

/// int w grad B_i dx over a patch, Dim x m, for weights given per cell.
template <int Dim, typename Weights>
ControlPoints<Dim> gradient_moments(const ElasticPatch<Dim>& patch, const Weights& weights_of) {
  ControlPoints<Dim> moments =
      ControlPoints<Dim>::Zero(Dim, std::ssize(patch.cells.control_points));
  for (std::size_t c = 0; c < patch.cells.cells.size(); ++c) {
    const GradientCell<Dim>& cell = patch.cells.cells[c];
    const Eigen::VectorXd weights = weights_of(c);
    for (int a = 0; a < Dim; ++a) {
      const Eigen::VectorXd sums =
          cell.gradients->middleCols(a * weights.size(), weights.size()) * weights;
      moments.row(a)(cell.positions) += sums.head(std::ssize(cell.positions)).transpose();
    }
  }
  return moments;
}

}  // namespace

template <int Dim>
void ElasticEnergy<Dim>::add_stiffness(double scale, const HessianPattern& pattern,
                                       std::span<double> stiffness) const {
  for (const ElasticPatch<Dim>& patch : patches_) {
    const auto& numbers = patch.cells.control_points;
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(std::ssize(numbers), std::ssize(numbers));
    for (std::size_t c = 0; c < patch.cells.cells.size(); ++c) {
      const GradientCell<Dim>& cell = patch.cells.cells[c];
      const Eigen::VectorXd weights = stand_in_weights(patch, c);
      const Eigen::MatrixXd& gradients = *cell.gradients;
      const Eigen::MatrixXd square =
          gradients * weights.replicate(Dim, 1).asDiagonal() * gradients.transpose();
      const auto k = std::ssize(cell.positions);
      sum(cell.positions, cell.positions) += square.topLeftCorner(k, k);
    }
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      for (std::size_t k = 0; k <= i; ++k) {
        if (sum(i, k) != 0) stiffness[pattern.slot(numbers[i], numbers[k])] += scale * sum(i, k);
      }
    }
  }
}

template <int Dim>
bool ElasticEnergy<Dim>::add_pull(const Eigen::Ref<const ControlPoints<Dim>>& phi0, double scale,
                                  ControlPoints<Dim>& pull) const {
  for (const ElasticPatch<Dim>& patch : patches_) {
    const auto& numbers = patch.cells.control_points;
    const ControlPoints<Dim> local = phi0(Eigen::all, numbers);
    const ControlPoints<Dim> moments =
        gradient_moments<Dim>(patch, [&](std::size_t c) { return patch.cells.cells[c].weights; });
    const Matrix<Dim> turn =
        nearest_rotation<Dim>(patch.measure * linear_ + local * moments.transpose()) - linear_;
    const ControlPoints<Dim> pulls = turn * gradient_moments<Dim>(patch, [&](std::size_t c) {
                                       return stand_in_weights(patch, c);
                                     });
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      pull.col(numbers[i]) += scale * pulls.col(i);
    }
  }
  return true;
}

template void ElasticEnergy<2>::add_stiffness(double, const HessianPattern&,
                                              std::span<double>) const;
template void ElasticEnergy<3>::add_stiffness(double, const HessianPattern&,
                                              std::span<double>) const;
template bool ElasticEnergy<2>::add_pull(const Eigen::Ref<const ControlPoints<2>>&, double,
                                         ControlPoints<2>&) const;
template bool ElasticEnergy<3>::add_pull(const Eigen::Ref<const ControlPoints<3>>&, double,
                                         ControlPoints<3>&) const;

}  // namespace crease
