#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "Applications/ProgressReporter.h"
#include "Applications/RegisterInput.h"
#include "Applications/RegisterOptions.h"
#include "Registration/AdaptiveRegistration.h"
#include "Registration/CreasedDomain.h"
#include "Registration/Registration.h"

namespace crease {

/// What a registration found, whatever the transform.
template <int Dim>
struct RegisterOutcome {
  std::shared_ptr<const Transform<Dim>> transform;
  std::optional<CreasedDomain> domain;  ///< of a triangular B-spline
  Alignment<Dim> alignment;
  double metric_before = 0;  ///< at the start; squares are of normalised intensities
  double metric_after = 0;
  std::vector<ChannelReport> channels;     ///< of the metric, likewise
  std::map<std::string, double> energies;  ///< unweighted
  std::map<std::string, double> weights;   ///< of these
  std::vector<LevelReport> levels;
  std::vector<RefinementRound> refinement;  ///< of patches
  std::optional<UnfoldingReport> unfolding;
  std::string stopped_because;
  int control_points = 0;
  Eigen::Index free_parameters = 0;
  double domain_measure = 0;  ///< mm^Dim
  bool converged = true;
  std::string failure;  ///< why there is no solution; empty: there is one
  bool improved = true;
};

/// Assembles the registration that the options describe and runs it. Warnings and timings go to the
/// report. When the solver fails, the outcome is the initial map, not converged, and says why.
template <int Dim>
RegisterOutcome<Dim> run_registration(const RegisterOptions& options,
                                      const RegisterInput<Dim>& input, RunReport& report,
                                      ProgressReporter& progress);

}  // namespace crease
