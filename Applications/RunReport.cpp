#include "Applications/RunReport.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "Applications/Resources.h"
#include "Applications/Sha256.h"
#include "Applications/Version.h"

namespace crease {
namespace {

constexpr int kFormatVersion = 1;

/// To the millisecond and the kilobyte: more digits would only be noise.
double rounded(double value) { return std::round(value * 1000) / 1000; }

}  // namespace

RunReport::RunReport(std::string command, int threads)
    : command_(std::move(command)), threads_(threads) {}

void RunReport::add_input(const std::string& option, const std::string& file) {
  inputs_.push_back({option, file, sha256_of_file(file)});
}

void RunReport::add_warnings(const std::vector<std::string>& texts) {
  warnings_.insert(warnings_.end(), texts.begin(), texts.end());
}

void RunReport::end_stage(const std::string& name) {
  const auto now = Clock::now();
  add_time(name,
           std::max(0.0, std::chrono::duration<double>(now - stage_start_).count() - parts_s_));
  stage_start_ = now;
  parts_s_ = 0;
  return_free_memory();
}

void RunReport::add_part(const std::string& name, double seconds) {
  add_time(name, seconds);
  parts_s_ += seconds;
}

void RunReport::add_time(const std::string& name, double seconds) {
  const auto stage = std::ranges::find(stages_, name, &Stage::name);
  if (stage == stages_.end()) {
    stages_.push_back({name, seconds});
  } else {
    stage->seconds += seconds;
  }
}

double RunReport::elapsed_s() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

nlohmann::ordered_json RunReport::result(const std::string& status,
                                         const nlohmann::ordered_json& figures) const {
  nlohmann::ordered_json inputs = nlohmann::ordered_json::array();
  for (const Input& input : inputs_) {
    inputs.push_back({{"option", input.option}, {"file", input.file}, {"sha256", input.hash}});
  }
  nlohmann::ordered_json timings;
  for (const Stage& stage : stages_) timings[stage.name] = rounded(stage.seconds);
  timings["total"] = rounded(elapsed_s());
  nlohmann::ordered_json result = {
      {"version", version_number()},
      {"command", command_},
      {"format_version", kFormatVersion},
      {"status", status},
      {"inputs", inputs},
      {"warnings", warnings_},
      {"timings_s", timings},
      {"peak_memory_mb", rounded(peak_memory_mb())},
      {"threads", threads_},
  };
  result.update(figures);
  return result;
}

std::string RunReport::to_json(const std::string& status,
                               const nlohmann::ordered_json& figures) const {
  constexpr int kIndent = 2;
  return result(status, figures)
             .dump(kIndent, ' ', false, nlohmann::json::error_handler_t::replace) +
         "\n";
}

}  // namespace crease
