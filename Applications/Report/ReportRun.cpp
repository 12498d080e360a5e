#include "Applications/Report/ReportRun.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "Core/Error.h"

namespace crease {

using Json = nlohmann::ordered_json;

void add_run_section(const Json& result, const std::string& config, HtmlReport& report) {
  report.begin_section("run", "Run");
  ReportTable inputs{.title = "Inputs", .columns = {"option", "file", "SHA-256"}};
  for (const Json& input : result.at("inputs")) {
    inputs.rows.push_back({"--" + input.at("option").get<std::string>(),
                           input.at("file").get<std::string>(),
                           input.at("sha256").get<std::string>()});
  }
  report.add_table(inputs);
  report.add_code(
      message("Effective configuration (config.toml): crease ",
              result.at("command").get<std::string>(), " --config config.toml repeats the run"),
      config);
  ReportTable run{
      .title = "Time and memory", .columns = {"what", "value"}, .numbers = {1}, .varies = true};
  for (const auto& [stage, seconds] : result.at("timings_s").items()) {
    run.rows.push_back({stage, fmt::format("{:.3f} s", seconds.get<double>())});
  }
  run.rows.push_back(
      {"peak memory", fmt::format("{:.0f} MB", result.at("peak_memory_mb").get<double>())});
  run.rows.push_back({"threads", result.at("threads").dump()});
  report.add_table(run);
  ReportTable notes{.title = "Notes", .columns = {"note"}};
  for (const Json& note : result.at("notes")) notes.rows.push_back({note.get<std::string>()});
  if (!notes.rows.empty()) report.add_table(notes);
  report.add_text("Made by crease " + result.at("version").get<std::string>() + ".");
}

}  // namespace crease
