#pragma once

#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace crease {

/// What every subcommand puts into result.json: which files it read, how it went and what it took.
class RunReport {
 public:
  RunReport(std::string command, int threads);

  /// An input file, recorded with its SHA-256. @throws FileError when it cannot be read.
  void add_input(const std::string& option, const std::string& file);
  void add_warning(const std::string& text) { warnings_.push_back(text); }
  void add_warnings(const std::vector<std::string>& texts);
  /// Ends the stage that began with the last call (or at the start) and names it. Stages of the same
  /// name add up. Gives memory that the stage has freed back to the system.
  void end_stage(const std::string& name);
  /// A part of the running stage that was measured elsewhere: it is not counted in the stage again.
  void add_part(const std::string& name, double seconds);

  const std::vector<std::string>& warnings() const { return warnings_; }
  double elapsed_s() const;

  /// The common fields, then the figures of the subcommand.
  /// @param status  "ok", "gate_failed" or "not_converged".
  nlohmann::ordered_json result(const std::string& status,
                                const nlohmann::ordered_json& figures) const;
  /// The same as the text of result.json.
  std::string to_json(const std::string& status, const nlohmann::ordered_json& figures) const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Input {
    std::string option, file, hash;
  };
  struct Stage {
    std::string name;
    double seconds;
  };
  void add_time(const std::string& name, double seconds);

  std::string command_;
  int threads_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point stage_start_ = start_;
  double parts_s_ = 0;
  std::vector<Input> inputs_;
  std::vector<std::string> warnings_;
  std::vector<Stage> stages_;
};

}  // namespace crease
