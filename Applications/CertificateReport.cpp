#include "Applications/CertificateReport.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace crease {
namespace {

using Json = nlohmann::ordered_json;

template <int Dim>
Json list(const Point<Dim>& p) {
  return std::vector<double>(p.begin(), p.end());
}

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(); }

template <int Dim>
Json to_json(const FailingRegion<Dim>& region) {
  Json corners = Json::array();
  for (const auto& corner : region.corners) corners.push_back(list<Dim>(corner));
  return {{"corners_mm", corners},         {"size_mm", finite(region.size_mm)},
          {"at_mm", list<Dim>(region.at)}, {"determinant", finite(region.determinant)},
          {"patch", region.patch},         {"part", region.part}};
}

}  // namespace

template <int Dim>
void add_certificate(const InvertibilityCertificate<Dim>& certificate, Json& jacobian) {
  const bool known = certificate.verdict != Invertibility::kNotCertifiable;
  jacobian["certified_positive"] = known ? Json(certificate.certified()) : Json();
  jacobian["certificate"] = {
      {"verdict", to_string(certificate.verdict)},
      {"lower_bound", finite(certificate.lower_bound)},
      {"failing_region", certificate.failing ? to_json(*certificate.failing) : Json()},
      {"patches", certificate.num_patches},
      {"patches_examined", certificate.num_examined},
      {"patches_failing", certificate.num_failing}};
}

Json to_json(const UnfoldingReport& unfolding) {
  return {{"rounds", unfolding.rounds},
          {"weight", unfolding.weight},
          {"share_of_way", unfolding.share},
          {"metric_folded", unfolding.folded_metric},
          {"certified", unfolding.certified}};
}

template <int Dim>
std::string certificate_text(const InvertibilityCertificate<Dim>& certificate) {
  if (certificate.certified()) {
    return fmt::format("certified everywhere in the domain, det >= {:.3g}",
                       certificate.lower_bound);
  }
  if (!certificate.failing) return "no certificate is known for this kind of transform";
  const FailingRegion<Dim>& region = *certificate.failing;
  std::string at;
  for (int a = 0; a < Dim; ++a) at += fmt::format("{}{:.5g}", a > 0 ? ", " : "", region.at[a]);
  const bool folded = certificate.verdict == Invertibility::kFolded;
  std::string text = fmt::format("not certified, det {:.3g} at ({}) mm", region.determinant, at);
  if (!folded) text += fmt::format(" undecided in a part of {:.3g} mm", region.size_mm);
  if (region.part > 0) text += fmt::format(" of part {}", region.part + 1);
  if (certificate.num_failing > 1) {
    text += fmt::format(", and in {} more of {} patches", certificate.num_failing - 1,
                        certificate.num_patches);
  }
  return text;
}

template void add_certificate(const InvertibilityCertificate<2>&, Json&);
template void add_certificate(const InvertibilityCertificate<3>&, Json&);
template std::string certificate_text(const InvertibilityCertificate<2>&);
template std::string certificate_text(const InvertibilityCertificate<3>&);

}  // namespace crease
