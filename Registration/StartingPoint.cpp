#include "Registration/StartingPoint.h"

#include "Optimizers/QuadraticMinimum.h"
#include "Registration/ScalarStiffness.h"

namespace crease {
namespace {

constexpr int kRenewals = 5;  // of what turns with the solution

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
