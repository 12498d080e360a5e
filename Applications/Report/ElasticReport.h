#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "Applications/ElasticFigures.h"
#include "Applications/Report/ReportStacks.h"

namespace crease {

/// The pixels that a report of `crease elastic` shows: those of a registration and the stiffness.
StackSources<2> stack_sources(const ElasticInput& input, const ElasticOutcome& outcome,
                              const ElasticImages& images);

/// report.html: an elastic registration to be judged by looking. The jobs of the stacks must have run; the
/// stacks are used up.
/// @param result  what result.json holds. @param config  what config.toml holds.
std::string elastic_report(const ElasticStory& story, const nlohmann::ordered_json& result,
                           const std::string& config, ReportStacks<2>& stacks);

}  // namespace crease
