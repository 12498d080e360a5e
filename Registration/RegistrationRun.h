#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include "Optimizers/DampedSolver.h"
#include "Registration/AdaptedWeights.h"
#include "Registration/ChannelMetric.h"
#include "Registration/RegistrationParts.h"

namespace crease {

/// One run of a registration, stage by stage: align, constrain, bind, start, optimise level by level,
/// report.
template <int Dim>
class RegistrationRun {
 public:
  RegistrationRun(const RegistrationParts<Dim>& parts, const RegistrationCallback& progress);
  RegistrationResult<Dim> execute();

 private:
  using Phi = Eigen::VectorXd;  // stacked control points
  using Terms = std::map<std::string, double>;
  struct Round : OptimizerResult {      // one minimisation
    std::vector<Terms> weighted_terms;  // of `history`
  };
  struct Level {
    int shrink = 1;
    std::shared_ptr<const BoundGrid<Dim>> grid;
    std::shared_ptr<ImageTerm<Dim>> image;  // null without images
    double image_weight = 0;                // alpha in the unit of the metric
    double bending_factor = 1;
    std::vector<double> counted_measures;  // of each channel's samples that count
    double correlated_measure = 0;         // in which a sample's noise is correlated
    double noise_floor = 0;                // values of the cost that are rounding alone
  };

  void check_parts() const;
  void normalise_images();
  void find_initial_map();
  void make_constraints();
  void make_levels();
  void choose_samples(std::size_t level, const std::vector<Phi>& starts);
  RowSubset rows_of_level(std::size_t level) const;
  void collect_energies();
  void make_solver();
  std::vector<std::size_t> similar_channels() const;
  std::vector<Phi> starts();
  Phi fitted_to_flow(const Phi& near, const std::vector<std::size_t>& similar);
  void optimise();
  std::map<std::string, double> terms_at(std::size_t level, const Phi& phi);
  double correlated_samples(std::size_t level) const;
  void keep_better(const Phi& start, Phi& phi);
  Phi solve_level(std::size_t l, const std::vector<Phi>& starts);
  Round minimise_from(const std::vector<Phi>& starts, std::size_t l, LevelReport& level);
  void book(const Round& round, LevelReport& level);
  bool renew_weights(std::size_t l, const LevelReport& level, const Phi& phi);
  void look_for_finer_places(const Phi& phi);
  BendingBalance image_noise(std::size_t l, double value, const Phi& phi);
  double determined_by(std::size_t l, const std::shared_ptr<Metric<Dim>>& metric, double weight,
                       const Phi& phi);
  bool folds(const Phi& phi) const;
  void make_invertible(const Phi& start, Phi& phi);
  Round optimise_level(std::size_t level, const Phi& start,
                       const std::shared_ptr<const Optimizer>& optimizer);
  void report(const Phi& phi);

  std::unique_ptr<RegistrationObjective<Dim>> objective(const Level& level) const;
  std::shared_ptr<const Optimizer> optimizer_of(std::size_t level, int max_iterations = 100);
  void tell(const std::string& stage, std::size_t level, int iteration, double energy);
  void add_time(const std::string& stage);

  const RegistrationParts<Dim>& parts_;
  const RegistrationCallback& progress_;
  bool cancelled_ = false;
  std::chrono::steady_clock::time_point last_time_ = std::chrono::steady_clock::now();

  std::vector<Channel<Dim>> compared_;  // normalised
  AffineMap<Dim> affine_;
  std::shared_ptr<const NullSpace> null_space_;
  std::shared_ptr<const HessianPattern> pattern_;
  std::vector<WeightedEnergy<Dim>> energies_;
  std::shared_ptr<DampedSolver> solver_;  // kept from level to level
  std::vector<ChannelLevels<Dim>> channels_;
  std::vector<Level> levels_;
  std::optional<AdaptedWeights<Dim>> weights_;  // where wanted
  RegistrationResult<Dim> result_;
};

extern template class RegistrationRun<2>;
extern template class RegistrationRun<3>;

}  // namespace crease
