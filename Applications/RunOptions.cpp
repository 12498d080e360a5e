#include "Applications/RunOptions.h"

#include "Applications/Resources.h"
#include "Core/Parallel.h"

namespace crease {

std::vector<Option> options_of(RunOptions& run) {
  return {
      {.name = "threads",
       .target = &run.threads,
       .placeholder = "N",
       .help = "Threads; without it what the machine, its control group or batch system grants",
       .minimum = 1,
       .maximum = 1024,
       .affects_results = false},
      {.name = "seed",
       .target = &run.seed,
       .placeholder = "N",
       .help = "Seed of every random choice",
       .minimum = 0},
      {.name = "progress",
       .target = &run.progress,
       .help = "How progress is told on the error stream: a bar on a terminal, else lines (auto)",
       .choices = {"auto", "bar", "lines", "json"},
       .affects_results = false},
      {.name = "quiet",
       .target = &run.quiet,
       .help = "Tell no progress and no warnings; errors are still told",
       .affects_results = false},
      {.name = "json",
       .target = &run.json,
       .help = "Print the result as JSON instead of a summary",
       .affects_results = false},
  };
}

int prepare_process(const RunOptions& run) {
  const int threads = run.threads.value_or(granted_threads());
  set_num_threads(threads);
  return threads;
}

}  // namespace crease
