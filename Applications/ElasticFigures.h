#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "Applications/ElasticOutput.h"
#include "Transforms/InvertibilityCertificate.h"

namespace crease {

/// All that `crease elastic` tells about a run.
struct ElasticStory {
  const ElasticCommandOptions& options;
  const ElasticInput& input;
  const ElasticOutcome& outcome;
  const Evaluation<2>& evaluation;
  const InvertibilityCertificate<2>& certificate;
  const std::optional<TargetErrors>& errors;
};

/// Figures for result.json.
nlohmann::ordered_json figures_json(const ElasticStory& story);

/// For people: areas, pairs, mesh, a line per load step and per iteration, improvements.
std::string summary_text(const ElasticStory& story, double seconds);

/// "86.41 %", "images already equal".
std::string improvement_text(const ElasticRegistrationResult& found,
                             const std::optional<double>& percent);

}  // namespace crease
