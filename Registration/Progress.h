#pragma once

#include <functional>
#include <string>

namespace crease {

/// Where a run stands: told after every iteration and at the start of every stage.
struct RegistrationProgress {
  std::string stage;  ///< "alignment", "domain", "start", "level", "results"
  int level = 0;      ///< 1 = coarsest
  int num_levels = 0;
  int iteration = 0;    ///< of the level
  double energy = 0;    ///< weighted sum
  double fraction = 0;  ///< done of the whole run, 0 to 1 (estimate)
};

/// Returns false to cancel: the run ends with the last good state.
using RegistrationCallback = std::function<bool(const RegistrationProgress&)>;

}  // namespace crease
