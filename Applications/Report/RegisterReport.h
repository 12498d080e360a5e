#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "Applications/RegisterOutput.h"
#include "Applications/RegisterRun.h"
#include "Applications/Report/ReportStacks.h"
#include "Registration/Evaluation.h"
#include "Transforms/InvertibilityCertificate.h"

namespace crease {

/// The pixels that a report of `crease register` shows.
template <int Dim>
StackSources<Dim> stack_sources(const RegisterOptions& options, const RegisterInput<Dim>& input,
                                const RegisterOutcome<Dim>& outcome,
                                const RegisterImages<Dim>& images);

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
std::string register_report(const RegisterStory<Dim>& story, ReportStacks<Dim>& stacks);

extern template StackSources<2> stack_sources<2>(const RegisterOptions&, const RegisterInput<2>&,
                                                 const RegisterOutcome<2>&,
                                                 const RegisterImages<2>&);
extern template StackSources<3> stack_sources<3>(const RegisterOptions&, const RegisterInput<3>&,
                                                 const RegisterOutcome<3>&,
                                                 const RegisterImages<3>&);
extern template std::string register_report<2>(const RegisterStory<2>&, ReportStacks<2>&);
extern template std::string register_report<3>(const RegisterStory<3>&, ReportStacks<3>&);

}  // namespace crease
