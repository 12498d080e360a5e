#include "Applications/EvaluationReport.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace crease {
namespace {

using Json = nlohmann::ordered_json;

template <int Dim>
Json list(const Vector<Dim>& v) {
  return std::vector<double>(v.begin(), v.end());
}

template <int Dim>
std::string point_text(const Point<Dim>& p) {
  std::string text = "(";
  for (int a = 0; a < Dim; ++a) text += fmt::format("{}{:.4g}", a > 0 ? ", " : "", p[a]);
  return text + ")";
}

std::string row(const std::string& name, const ErrorStatistics& e) {
  return fmt::format("{:<22} mean {:.4f}  median {:.4f}  95 % {:.4f}  max {:.4f} mm  ({})\n", name,
                     e.mean, e.median, e.percentile_95, e.maximum, e.count);
}

}  // namespace

Json to_json(const ErrorStatistics& errors) {
  return {{"count", errors.count},   {"mean", errors.mean},         {"rms", errors.rms},
          {"median", errors.median}, {"p95", errors.percentile_95}, {"max", errors.maximum}};
}

template <int Dim>
Json to_json(const JacobianEvaluation<Dim>& jacobian) {
  return {{"min", jacobian.minimum},
          {"max", jacobian.maximum},
          {"mean", jacobian.mean},
          {"folded_samples", jacobian.folded},
          {"folded_fraction", jacobian.folded_fraction},
          {"min_at_mm", list<Dim>(jacobian.minimum_at)}};
}

template <int Dim>
Json to_json(const BodyEvaluation<Dim>& body) {
  Json json = {{"label", body.label},
               {"angle_deg", body.angle_deg},
               {"shift_mm", list<Dim>(body.shift_mm)},
               {"rms_nonrigidity_mm", body.rms_nonrigidity_mm}};
  if (body.error) {
    json["error_mm"] = to_json(*body.error);
    json["angle_error_deg"] = body.angle_error_deg;
    json["shift_error_mm"] = body.shift_error_mm;
  }
  return json;
}

template <int Dim>
Json to_json(const Evaluation<Dim>& evaluation) {
  Json json = {{"samples", evaluation.samples}, {"jacobian", to_json(evaluation.jacobian)}};
  if (evaluation.error) json["error_mm"] = to_json(*evaluation.error);
  if (evaluation.error_within_3) json["error_within_3_px_mm"] = to_json(*evaluation.error_within_3);
  if (evaluation.error_within_10) {
    json["error_within_10_px_mm"] = to_json(*evaluation.error_within_10);
  }
  if (evaluation.landmarks) {
    json["landmarks_mm"] = to_json(*evaluation.landmarks);
    json["landmark_errors_mm"] = evaluation.landmark_errors_mm;
  }
  if (!evaluation.bodies.empty()) {
    json["bodies"] = Json::array();
    for (const auto& body : evaluation.bodies) json["bodies"].push_back(to_json(body));
  }
  if (!evaluation.labels.empty()) {
    json["labels"] = Json::array();
    for (const LabelOverlap& label : evaluation.labels) {
      json["labels"].push_back({{"label", label.label},
                                {"dice", label.dice},
                                {"hausdorff_95_mm", label.hausdorff_95_mm}});
    }
  }
  if (evaluation.match) {
    json["ssd"] = {{"before", evaluation.match->ssd_before},
                   {"after", evaluation.match->ssd_after}};
    json["ssd_reduction_percent"] = evaluation.match->ssd_reduction_percent;
    json["ncc"] = {{"before", evaluation.match->ncc_before},
                   {"after", evaluation.match->ncc_after}};
  }
  return json;
}

template <int Dim>
std::string summary(const Evaluation<Dim>& evaluation) {
  const auto& jacobian = evaluation.jacobian;
  std::string text =
      fmt::format("{:<22} {:.4g} to {:.4g}, {} of {} samples folded\n", "Jacobian",
                  jacobian.minimum, jacobian.maximum, jacobian.folded, evaluation.samples);
  if (evaluation.error) text += row("error", *evaluation.error);
  if (evaluation.error_within_3) text += row("  3 px from borders", *evaluation.error_within_3);
  if (evaluation.error_within_10) text += row("  10 px from borders", *evaluation.error_within_10);
  if (evaluation.landmarks) text += row("landmarks", *evaluation.landmarks);
  for (const auto& body : evaluation.bodies) {
    text += fmt::format("{:<22} {:.3f} degrees, shift {} mm, {:.4f} mm from rigid\n",
                        fmt::format("body {}", body.label), body.angle_deg,
                        point_text<Dim>(body.shift_mm), body.rms_nonrigidity_mm);
    if (!body.error) continue;
    text += row("  error", *body.error);
    text += fmt::format("{:<22} {:.4f} degrees, {:.4f} mm\n", "  rigid motion off by",
                        body.angle_error_deg, body.shift_error_mm);
  }
  for (const LabelOverlap& label : evaluation.labels) {
    text += fmt::format("{:<22} Dice {:.4f}, 95 % Hausdorff distance {:.3f} mm\n",
                        fmt::format("label {}", label.label), label.dice, label.hausdorff_95_mm);
  }
  if (evaluation.match) {
    const MatchEvaluation& match = *evaluation.match;
    text += std::isnan(match.ncc_before)
                ? fmt::format("{:<22} NCC {:.4f}; no overlap before\n", "images", match.ncc_after)
                : fmt::format("{:<22} SSD {:.2f} % less, NCC {:.4f} -> {:.4f}\n", "images",
                              match.ssd_reduction_percent, match.ncc_before, match.ncc_after);
  }
  return text;
}

template <int Dim>
std::string folding_text(const JacobianEvaluation<Dim>& jacobian, std::int64_t samples) {
  return fmt::format("the map folds at {} of {} samples ({:.3g} %), worst near {} mm (det {:.3g})",
                     jacobian.folded, samples, 100 * jacobian.folded_fraction,
                     point_text<Dim>(jacobian.minimum_at), jacobian.minimum);
}

template Json to_json<2>(const Evaluation<2>&);
template Json to_json<3>(const Evaluation<3>&);
template std::string summary<2>(const Evaluation<2>&);
template std::string summary<3>(const Evaluation<3>&);
template std::string folding_text<2>(const JacobianEvaluation<2>&, std::int64_t);
template std::string folding_text<3>(const JacobianEvaluation<3>&, std::int64_t);

}  // namespace crease
