#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "Applications/ExitCode.h"
#include "Applications/Option.h"

namespace crease {

/// One of the things that `crease` does. Options write into variables that the subcommand's run() reads.
struct Subcommand {
  std::string name;
  std::string summary;  ///< one line
  std::string details;  ///< what the help says below the options: results, a realistic example
  std::vector<Option> options;
  /// Options of which at most one may be given.
  std::vector<std::vector<std::string>> exclusive = {};
  /// @param effective_config  the configuration file that repeats this call.
  std::function<ExitCode(const std::string& effective_config)> run;
};

/// Reads the command line and the configuration file, which the command line overrules, and runs the
/// subcommand. Every error becomes one message on the error stream and an exit code; no exception
/// leaves.
///
/// @param version  what --version prints.
int run_command(int argc, const char* const* argv, std::span<const Subcommand> subcommands,
                const std::string& version);

}  // namespace crease
