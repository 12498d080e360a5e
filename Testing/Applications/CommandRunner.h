#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace crease::testing {

/// What a run of a program left.
struct CommandResult {
  int code = -1;  ///< exit code; 128 + signal when it was killed
  std::string out, err;
};

/// Runs a program with these arguments, in a process of its own, and waits for it.
CommandResult run_program(const std::string& program, const std::vector<std::string>& arguments);

/// The same with the built `crease`.
CommandResult run_crease(const std::vector<std::string>& arguments);

/// Starts it, kills it with SIGKILL as soon as `when` is true of what it has told on its error stream, and
/// waits.
/// @return false when it ended by itself before.
bool kill_crease(const std::vector<std::string>& arguments,
                 const std::function<bool(const std::string& err)>& when);

/// DIR/result.json. @throws when it is missing or no JSON.
nlohmann::json read_result(const std::filesystem::path& folder);

/// A file below the folder of optional test data; empty when it is not there.
std::string shared_file(const std::string& name);

}  // namespace crease::testing
