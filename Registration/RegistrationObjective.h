#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "Optimizers/ObjectiveFunction.h"
#include "Registration/ImageTerm.h"
#include "Transforms/Energies/Energy.h"

namespace crease {

/// An energy with its weight and the name it is reported by.
template <int Dim>
struct WeightedEnergy {
  std::string name;
  double weight = 1;
  std::shared_ptr<const Energy<Dim>> energy;
};

/// The cost of a registration at one level: E = alpha E_I + sum_k weight_k E_k, as a function of the
/// stacked control points (x[Dim * i + a] = coordinate a of control point i, mm).
///
/// Source: dissertation, (3.3).
template <int Dim>
class RegistrationObjective final : public ObjectiveFunction {
 public:
  /// @param image  null for a registration by landmarks and energies alone.
  RegistrationObjective(std::shared_ptr<const HessianPattern> pattern,
                        std::shared_ptr<ImageTerm<Dim>> image, double image_weight,
                        std::vector<WeightedEnergy<Dim>> energies);

  Eigen::Index size() const override;
  /// Infinite where so few samples fall inside the moving image that a metric refuses, or where an energy is
  /// infinite (neo-Hookean tissue turned inside out), unless no point was evaluated before.
  /// @throws SolverError there, and when a term is not a number; the message names the term.
  double evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient,
                  Eigen::SparseMatrix<double>* hessian) override;
  /// Gauss-Newton's matrix at x, with weak springs for what it does not see. Where no energy couples
  /// coordinates, half the trace of its blocks (a third in 3D) serves them all: bending, and a mass
  /// matrix weighted by the images' curvature.
  bool preconditioner(const Eigen::Ref<const Eigen::VectorXd>& x,
                      Eigen::SparseMatrix<double>& matrix) override;
  /// Largest displacement of the step over the samples, in pixels; mm without an image.
  double step_length(const Eigen::Ref<const Eigen::VectorXd>& step) const override;

  /// Unweighted terms of the last evaluation, by name; "image" is the metric.
  const std::map<std::string, double>& terms() const { return terms_; }
  /// The same times their weights: they sum up to the value.
  std::map<std::string, double> weighted_terms() const;

 private:
  std::shared_ptr<const HessianPattern> pattern_;
  std::shared_ptr<ImageTerm<Dim>> image_;
  double image_weight_;
  std::vector<WeightedEnergy<Dim>> energies_;
  BlockHessian<Dim> hessian_;
  std::map<std::string, double> terms_;
  bool evaluated_ = false;  // at least once
};

extern template class RegistrationObjective<2>;
extern template class RegistrationObjective<3>;

}  // namespace crease
