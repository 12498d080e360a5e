#include "Registration/StartingPoint.h"

#include <Eigen/SparseCore>

#include "Optimizers/QuadraticMinimum.h"

namespace crease {
namespace {

constexpr int kRenewals = 5;       // of what turns with the solution
constexpr double kSprings = 1e-6;  // of the mean stiffness: makes the minimum unique

/// Springs between all control points that couple, weak beside everything else: they hold what no
/// energy sees, the interior of bodies and affine maps.
void add_springs(const HessianPattern& pattern, std::vector<double>& stiffness) {
  double sum = 0;
  for (int i = 0; i < pattern.size(); ++i) sum += stiffness[pattern.row_start()[i + 1] - 1];
  const double mean = pattern.size() > 0 ? sum / pattern.size() : 0;
  const double spring = (mean > 0 ? kSprings * mean : 1.0) * pattern.size() / pattern.num_entries();
  for (int i = 0; i < pattern.size(); ++i) {
    const int diagonal = pattern.row_start()[i + 1] - 1;
    for (int s = pattern.row_start()[i]; s < diagonal; ++s) {
      stiffness[s] -= spring;
      stiffness[diagonal] += spring;
      stiffness[pattern.row_start()[pattern.columns()[s] + 1] - 1] += spring;
    }
  }
}

/// Entries (i, k), k <= i, as the lower triangle of a symmetric matrix, times the identity of `copies`.
Eigen::SparseMatrix<double> lower_triangle(const HessianPattern& pattern,
                                           const std::vector<double>& entries, int copies) {
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(copies * entries.size());
  for (int i = 0; i < pattern.size(); ++i) {
    for (int s = pattern.row_start()[i]; s < pattern.row_start()[i + 1]; ++s) {
      for (int a = 0; a < copies; ++a) {
        triplets.emplace_back(copies * i + a, copies * pattern.columns()[s] + a, entries[s]);
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(copies * pattern.size(), copies * pattern.size());
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

}  // namespace

template <int Dim>
StartingPoint<Dim>::StartingPoint(std::shared_ptr<const HessianPattern> pattern,
                                  const NullSpace& null_space,
                                  const std::vector<WeightedEnergy<Dim>>& energies)
    : pattern_(std::move(pattern)), null_space_(null_space), energies_(energies) {}

template <int Dim>
Eigen::VectorXd StartingPoint<Dim>::minimum(std::vector<double> stiffness,
                                            const ControlPoints<Dim>& pull,
                                            Eigen::VectorXd phi) const {
  for (const auto& [name, weight, energy] : energies_) {
    energy->add_stiffness(weight, *pattern_, stiffness);
  }
  add_springs(*pattern_, stiffness);
  const int copies = null_space_.num_columns() == Dim ? 1 : Dim;  // constraints couple coordinates
  const QuadraticMinimizer solver(lower_triangle(*pattern_, stiffness, copies), null_space_);
  for (int renewal = 0; renewal <= kRenewals; ++renewal) {
    ControlPoints<Dim> b = pull;
    bool turns = false;
    for (const auto& [name, weight, energy] : energies_) {
      turns |= energy->add_pull(phi.reshaped(Dim, pattern_->size()), weight, b);
    }
    phi = solver.minimum(b.reshaped());
    if (!turns) break;
  }
  return phi;
}

template <int Dim>
Eigen::VectorXd StartingPoint<Dim>::smoothest() const {
  const std::vector<double> none(static_cast<std::size_t>(pattern_->num_entries()), 0.0);
  return minimum(none, ControlPoints<Dim>::Zero(Dim, pattern_->size()),
                 Eigen::VectorXd::Zero(Dim * pattern_->size()));
}

template <int Dim>
Eigen::VectorXd StartingPoint<Dim>::fitted_to(ImageTerm<Dim>& target,
                                              const Eigen::VectorXd& near) const {
  const ControlPoints<Dim> rest = ControlPoints<Dim>::Zero(Dim, pattern_->size());
  ControlPoints<Dim> gradient = rest;
  BlockHessian<Dim> curvature(pattern_);
  target.evaluate(rest, 1, &gradient, &curvature);
  std::vector<double> stiffness(static_cast<std::size_t>(pattern_->num_entries()));
  for (int s = 0; s < pattern_->num_entries(); ++s) stiffness[s] = curvature.block(s)(0, 0);
  return minimum(std::move(stiffness), -gradient, near);
}

template <int Dim>
Eigen::VectorXd StartingPoint<Dim>::nearest_to(
    const SplineBasis<Dim>& basis, const DisplacementFunction<Dim>& displacement) const {
  const ProjectionSystem<Dim> system = projection_system(basis, displacement);
  std::vector<double> mass(static_cast<std::size_t>(pattern_->num_entries()), 0.0);
  for (int i = 0; i < pattern_->size(); ++i) {
    for (int s = pattern_->row_start()[i]; s < pattern_->row_start()[i + 1]; ++s) {
      mass[static_cast<std::size_t>(s)] = system.mass.coeff(i, pattern_->columns()[s]);
    }
  }
  const int copies = null_space_.num_columns() == Dim ? 1 : Dim;
  return QuadraticMinimizer(lower_triangle(*pattern_, mass, copies), null_space_)
      .minimum(system.rhs.reshaped());
}

template class StartingPoint<2>;
template class StartingPoint<3>;

}  // namespace crease
