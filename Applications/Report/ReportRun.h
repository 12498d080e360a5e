#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "Applications/Report/HtmlReport.h"

namespace crease {

/// The last section of a report: inputs, configuration, times, memory, notes and version.
/// @param result  what result.json holds. @param config  what config.toml holds.
void add_run_section(const nlohmann::ordered_json& result, const std::string& config,
                     HtmlReport& report);

}  // namespace crease
