#pragma once

#include <optional>
#include <string>
#include <vector>

#include "Applications/Option.h"

namespace crease {

/// What every subcommand takes besides its own options.
struct RunOptions {
  std::optional<int> threads;
  int seed = 1;
  std::string progress = "auto";
  bool quiet = false;
  bool json = false;
};

/// The options that set these; to be put behind a subcommand's own.
std::vector<Option> options_of(RunOptions& run);

/// Limits the process to the threads asked for or granted, and silences what libraries print.
/// @return the number of threads.
int prepare_process(const RunOptions& run);

}  // namespace crease
