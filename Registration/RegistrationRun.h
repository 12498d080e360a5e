#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "Optimizers/DampedSolver.h"
#include "Registration/AdaptedWeights.h"
#include "Registration/RegistrationFrame.h"

namespace crease {

/// One run of a registration by splines, stage by stage: align, constrain, bind, start, optimise level by
/// level, report. The members are defined in files by stage: RegistrationRun.cpp (set-up),
/// RegistrationStarts.cpp, RegistrationLevels.cpp and RegistrationResults.cpp.
template <int Dim>
class RegistrationRun : private RegistrationFrame<Dim> {
 public:
  RegistrationRun(const RegistrationParts<Dim>& parts, const RegistrationCallback& progress)
      : Base(parts, progress) {
    check_parts();
  }
  RegistrationResult<Dim> execute();

 private:
  using Base = RegistrationFrame<Dim>;
  using Base::affine_;
  using Base::cancelled_;
  using Base::channels_;
  using Base::compared_;
  using Base::num_levels_;
  using Base::parts_;
  using Base::result_;
  using typename Base::Round;
  using Phi = Eigen::VectorXd;  // stacked control points
  struct Level {
    int shrink = 1;
    std::shared_ptr<const BoundGrid<Dim>> grid;
    std::shared_ptr<ImageTerm<Dim>> image;  // null without images
    double image_weight = 0;                // alpha in the unit of the metric
    double bending_factor = 1;
    std::vector<double> counted_measures;  // of each channel's samples that count
    double noise_floor = 0;                // values of the cost that are rounding alone
  };

  void check_parts() const;
  void make_constraints();
  void collect_energies();
  void make_solver();
  void make_levels();
  /// Which samples count is chosen for the whole of a level, by all starts, so that their number never jumps.
  void choose_samples(std::size_t level, const std::vector<Phi>& starts);
  std::unique_ptr<RegistrationObjective<Dim>> objective(const Level& level) const;
  void optimise();

  std::vector<Phi> starts();
  std::vector<std::size_t> similar_channels() const;
  Phi fitted_to_flow(const Phi& near, const std::vector<std::size_t>& similar);

  std::shared_ptr<const Optimizer> optimizer_of(std::size_t level, int max_iterations = 100);
  Phi solve_level(std::size_t l, const std::vector<Phi>& starts);
  Round minimise_from(const std::vector<Phi>& starts, std::size_t l, LevelReport& level);
  Round optimise_level(std::size_t level, const Phi& start,
                       const std::shared_ptr<const Optimizer>& optimizer);
  std::map<std::string, double> terms_at(std::size_t level, const Phi& phi);
  void keep_better(const Phi& start, Phi& phi);

  bool renew_weights(std::size_t l, const LevelReport& level, const Phi& phi);
  BendingBalance image_noise(std::size_t l, double value, const Phi& phi);
  double determined_by(std::size_t l, const std::shared_ptr<Metric<Dim>>& metric, double weight,
                       const Phi& phi);
  bool folds(const Phi& phi) const;
  void make_invertible(const Phi& start, Phi& phi);
  void look_for_finer_places(const Phi& phi);
  void report(const Phi& phi);

  std::shared_ptr<const NullSpace> null_space_;
  std::shared_ptr<const HessianPattern> pattern_;
  std::vector<WeightedEnergy<Dim>> energies_;
  std::shared_ptr<DampedSolver> solver_;  // kept from level to level
  std::vector<Level> levels_;
  std::optional<AdaptedWeights<Dim>> weights_;  // where wanted
};

extern template class RegistrationRun<2>;
extern template class RegistrationRun<3>;

}  // namespace crease
