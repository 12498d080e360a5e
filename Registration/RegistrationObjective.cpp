#include "Registration/RegistrationObjective.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "Core/Error.h"
#include "Metrics/MetricInput.h"
#include "Registration/ScalarStiffness.h"

namespace crease {
namespace {

void require_finite(double value, const std::string& term) {
  if (std::isfinite(value)) return;
  throw SolverError(message("the ", term, " energy became ", value,
                            " during the registration; lower the weights or start closer to the "
                            "solution (--init landmarks, more levels)."));
}

}  // namespace

template <int Dim>
RegistrationObjective<Dim>::RegistrationObjective(std::shared_ptr<const HessianPattern> pattern,
                                                  std::shared_ptr<ImageTerm<Dim>> image,
                                                  double image_weight,
                                                  std::vector<WeightedEnergy<Dim>> energies)
    : pattern_(std::move(pattern)),
      image_(std::move(image)),
      image_weight_(image_weight),
      energies_(std::move(energies)),
      hessian_(pattern_) {}

template <int Dim>
Eigen::Index RegistrationObjective<Dim>::size() const {
  return static_cast<Eigen::Index>(Dim) * pattern_->size();
}

template <int Dim>
double RegistrationObjective<Dim>::evaluate(const Eigen::Ref<const Eigen::VectorXd>& x,
                                            Eigen::VectorXd* gradient,
                                            Eigen::SparseMatrix<double>* hessian) {
  const Eigen::Map<const ControlPoints<Dim>> phi(x.data(), Dim, pattern_->size());
  ControlPoints<Dim> forces;
  ControlPoints<Dim>* forces_wanted = nullptr;
  if (gradient != nullptr) {
    forces = ControlPoints<Dim>::Zero(Dim, pattern_->size());
    forces_wanted = &forces;
  }
  BlockHessian<Dim>* curvature = hessian != nullptr ? &hessian_ : nullptr;
  if (curvature != nullptr) curvature->set_zero();

  double value = 0;
  if (image_ != nullptr && image_weight_ > 0) {
    double term = 0;
    try {
      term = image_->evaluate(phi, image_weight_, forces_wanted, curvature);
    } catch (const OverlapError&) {  // a step that went too far, but for the start
      if (!evaluated_) throw;
      return std::numeric_limits<double>::infinity();
    }
    require_finite(term, "image");
    terms_["image"] = term;
    value += image_weight_ * term;
  }
  for (const auto& [name, weight, energy] : energies_) {
    const double term = energy->evaluate(phi, weight, forces_wanted, curvature);
    // Tissue that would be turned inside out: a step that went too far, but for the start.
    if (evaluated_ && term == std::numeric_limits<double>::infinity()) return term;
    require_finite(term, name);
    terms_[name] = term;
    value += weight * term;
  }
  evaluated_ = true;
  if (gradient != nullptr) *gradient = forces.reshaped();
  if (hessian != nullptr) hessian_.to_sparse(*hessian);
  return value;
}

template <int Dim>
std::map<std::string, double> RegistrationObjective<Dim>::weighted_terms() const {
  std::map<std::string, double> weighted;
  for (const auto& [name, term] : terms_) weighted[name] = image_weight_ * term;
  for (const auto& energy : energies_) {
    const auto term = terms_.find(energy.name);
    if (term != terms_.end()) weighted[energy.name] = energy.weight * term->second;
  }
  return weighted;
}

template <int Dim>
bool RegistrationObjective<Dim>::preconditioner(const Eigen::Ref<const Eigen::VectorXd>& x,
                                                Eigen::SparseMatrix<double>& matrix) {
  evaluate(x, nullptr, &matrix);
  const auto entries = static_cast<std::size_t>(pattern_->num_entries());
  std::vector<double> stiffness(entries);
  for (std::size_t s = 0; s < entries; ++s) {
    stiffness[s] = hessian_.block(static_cast<int>(s)).trace() / Dim;
  }
  const std::vector<double> without = stiffness;
  add_springs(*pattern_, stiffness);
  const bool coupled = std::ranges::any_of(
      energies_, [](const auto& energy) { return energy.energy->couples_coordinates(); });
  if (!coupled) {
    matrix = lower_triangle(*pattern_, stiffness);
    return true;
  }
  for (std::size_t s = 0; s < entries; ++s) {
    hessian_.block(static_cast<int>(s)).diagonal().array() += stiffness[s] - without[s];
  }
  hessian_.to_sparse(matrix);
  return true;
}

template <int Dim>
double RegistrationObjective<Dim>::step_length(
    const Eigen::Ref<const Eigen::VectorXd>& step) const {
  if (image_ == nullptr) return ObjectiveFunction::step_length(step);
  const Eigen::Map<const ControlPoints<Dim>> phi(step.data(), Dim, pattern_->size());
  return image_->largest_step(phi);
}

template class RegistrationObjective<2>;
template class RegistrationObjective<3>;

}  // namespace crease
