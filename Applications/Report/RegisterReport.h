#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "Applications/RegisterRun.h"
#include "Applications/Report/RegisterStacks.h"
#include "Registration/Evaluation.h"
#include "Transforms/InvertibilityCertificate.h"

namespace crease {

/// What a report of `crease register` tells.
template <int Dim>
struct RegisterStory {
  const RegisterOptions& options;
  const RegisterInput<Dim>& input;
  const RegisterOutcome<Dim>& outcome;
  const Evaluation<Dim>& evaluation;
  const InvertibilityCertificate<Dim>& certificate;
  const nlohmann::ordered_json& result;  ///< what result.json holds
  const std::string& config;             ///< what config.toml holds
};

/// report.html: a registration to be judged by looking. The jobs of the stacks must have run; the stacks
/// are used up.
template <int Dim>
std::string register_report(const RegisterStory<Dim>& story, RegisterStacks<Dim>& stacks);

extern template std::string register_report<2>(const RegisterStory<2>&, RegisterStacks<2>&);
extern template std::string register_report<3>(const RegisterStory<3>&, RegisterStacks<3>&);

}  // namespace crease
