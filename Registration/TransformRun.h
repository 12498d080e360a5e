#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "Optimizers/DampedSolver.h"
#include "Registration/AdaptedWeights.h"
#include "Registration/RegistrationFrame.h"
#include "Registration/TransformObjective.h"

namespace crease {

/// One run of a registration whose transform may be any (Registration::transform): align, constrain,
/// optimise level by level, report. Its cost is a TransformObjective.
template <int Dim>
class TransformRun : private RegistrationFrame<Dim> {
 public:
  using RegistrationFrame<Dim>::RegistrationFrame;
  RegistrationResult<Dim> execute();

 private:
  using Base = RegistrationFrame<Dim>;
  using Base::affine_;
  using Base::cancelled_;
  using Base::channels_;
  using Base::num_levels_;
  using Base::parts_;
  using Base::result_;
  using typename Base::Round;
  using Objective = TransformObjective<Dim>;

  void check_parts() const;
  void make_transform();
  void make_constraints();
  std::unique_ptr<Objective> objective(std::size_t level, const Eigen::VectorXd& start);
  void set_weights(std::size_t level, Objective& cost) const;
  double weight_of(const std::string& name) const;
  Eigen::VectorXd solve_level(std::size_t level, const Eigen::VectorXd& start);
  Round minimise(std::size_t level, Objective& cost, const Eigen::VectorXd& start);
  bool renew_weights(std::size_t level, Objective& cost, const LevelReport& report,
                     const Eigen::VectorXd& parameters);
  void report(Objective& finest, const Eigen::VectorXd& parameters);

  std::unique_ptr<Transform<Dim>> transform_;  // at rest: T = A
  SoftLandmarks<Dim> soft_landmarks_;
  std::shared_ptr<const NullSpace> null_space_;
  std::shared_ptr<DampedSolver> solver_;
  std::vector<std::shared_ptr<const TransformLattice<Dim>>> lattices_;
  double counted_measure_ = 0;  // of the samples that count at the present level
  std::vector<WeightedEnergy<Dim>>
      weights_;  // "bending", the roughness, and "landmarks"; no energies
  std::optional<AdaptedWeights<Dim>> adapted_;  // where wanted
};

extern template class TransformRun<2>;
extern template class TransformRun<3>;

}  // namespace crease
