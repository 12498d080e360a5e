#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "Registration/Registration.h"
#include "Transforms/InvertibilityCertificate.h"

namespace crease {

/// Adds `certified_positive` (null where the transform is not certifiable) and `certificate` to the figures of a
/// Jacobian. Times are not among them: they go to the report's stages.
template <int Dim>
void add_certificate(const InvertibilityCertificate<Dim>& certificate,
                     nlohmann::ordered_json& jacobian);

/// How the map was made invertible, for result.json.
nlohmann::ordered_json to_json(const UnfoldingReport& unfolding);

/// "certified in the whole domain, det >= 0.31", or why not: a line for people.
template <int Dim>
std::string certificate_text(const InvertibilityCertificate<Dim>& certificate);

}  // namespace crease
