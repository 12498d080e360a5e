#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "Registration/Evaluation.h"

namespace crease {

/// The figures of an evaluation as result.json holds them; what was not evaluated is left out.
template <int Dim>
nlohmann::ordered_json to_json(const Evaluation<Dim>& evaluation);

/// The parts that other reports use as well.
nlohmann::ordered_json to_json(const ErrorStatistics& errors);
template <int Dim>
nlohmann::ordered_json to_json(const JacobianEvaluation<Dim>& jacobian);
template <int Dim>
nlohmann::ordered_json to_json(const BodyEvaluation<Dim>& body);

/// A table for people, over several lines.
template <int Dim>
std::string summary(const Evaluation<Dim>& evaluation);

/// "the map folds at 12 of 262144 samples (0.0046 %), worst near (12.5, 30) mm (det -0.2)".
template <int Dim>
std::string folding_text(const JacobianEvaluation<Dim>& jacobian, std::int64_t samples);

}  // namespace crease
