#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "Optimizers/GaussNewton.h"
#include "Registration/ChannelMetric.h"
#include "Registration/RegistrationParts.h"
#include "Registration/RowSubset.h"

namespace crease {

/// What the runs of all transforms share: images in units of their own range, the affine map that they
/// start from, the pyramids and the samples that count, optimizers and when they stop, progress, times, and
/// the result as it fills.
template <int Dim>
class RegistrationFrame {
 public:
  RegistrationFrame(const RegistrationParts<Dim>& parts, const RegistrationCallback& progress)
      : parts_(parts), progress_(progress) {}

 protected:
  using Terms = std::map<std::string, double>;
  /// One minimisation.
  struct Round : OptimizerResult {
    std::vector<Terms> weighted_terms;  // of `history`
  };
  /// The samples of a level that count, channel by channel.
  struct Counted {
    std::vector<std::vector<float>> weights;
    std::vector<double> measures;  // mm^Dim
  };

  void normalise_images();
  void find_initial_map();
  void make_channel_levels();
  /// All but those that a start maps outside the moving image or to its very border; all where hardly any would
  /// be left. Of these only the rows that are looked at have weights.
  Counted counted_samples(std::size_t level, const BoundGrid<Dim>& grid,
                          const std::vector<ControlPoints<Dim>>& starts) const;
  /// The rows of samples that are looked at: all of them at the finest level.
  RowSubset rows_of_level(std::size_t level) const;
  /// Area or volume in which the noise of a sample is correlated, mm^Dim: its own, times what the filters of
  /// the pyramid have joined.
  double correlated_measure(std::size_t level) const;
  /// @param last  nothing follows that could better what this leaves.
  OptimizerOptions stopping_rule(bool finest, bool last, bool in_units_of_noise,
                                 int max_iterations) const;
  /// The one that was given, else one of the kind asked for.
  std::shared_ptr<const Optimizer> optimizer(OptimizerOptions stopping,
                                             const GaussNewtonOptions& gauss_newton) const;
  /// Books one minimisation of a level.
  void book(const Round& round, LevelReport& level);
  void warn_of_limit(std::size_t level, const OptimizerResult& round);
  /// @param metric  that of the finest level.
  /// @param at      evaluates it, by rows, at a map: 0 the start, 1 the end.
  void report_images(const std::shared_ptr<Metric<Dim>>& metric,
                     const std::function<double(int)>& at);
  void report_landmarks(const Transform<Dim>& transform);

  void tell(const std::string& stage, std::size_t level, int iteration, double energy);
  void add_time(const std::string& stage);

  const RegistrationParts<Dim>& parts_;
  const RegistrationCallback& progress_;
  bool cancelled_ = false;
  std::vector<Channel<Dim>> compared_;  // normalised
  AffineMap<Dim> affine_;
  std::vector<ChannelLevels<Dim>> channels_;
  std::size_t num_levels_ = 1;
  RegistrationResult<Dim> result_;

 private:
  std::chrono::steady_clock::time_point last_time_ = std::chrono::steady_clock::now();
};

extern template class RegistrationFrame<2>;
extern template class RegistrationFrame<3>;

}  // namespace crease
