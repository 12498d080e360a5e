#include "Applications/Report/ReportFolds.h"

#include <fmt/format.h>

#include "Applications/CertificateReport.h"
#include "Applications/EvaluationReport.h"
#include "Applications/Report/ReportText.h"

namespace crease {

template <int Dim>
std::vector<ReportHead::Statement> fold_statements(
    const Evaluation<Dim>& evaluation, const InvertibilityCertificate<Dim>& certificate) {
  const auto& jacobian = evaluation.jacobian;
  std::vector<ReportHead::Statement> statements;
  if (jacobian.folded > 0) {
    std::string text = folding_text(jacobian, evaluation.samples) + ".";
    text.front() = 'T';  // "the map folds ..."
    statements.push_back({ReportMood::kBad, text});
  } else {
    statements.push_back({ReportMood::kGood,
                          fmt::format("No folds at {} samples: determinants from {} to {}.",
                                      count_text(evaluation.samples), short_text(jacobian.minimum),
                                      short_text(jacobian.maximum))});
  }
  const std::string text = "Invertible: " + certificate_text(certificate) + ".";
  switch (certificate.verdict) {
    case Invertibility::kCertified:
      statements.push_back({ReportMood::kGood, text});
      break;
    case Invertibility::kFolded:
      statements.push_back({ReportMood::kBad, text});
      break;
    case Invertibility::kUndecided:
      statements.push_back({ReportMood::kCaution, text});
      break;
    case Invertibility::kNotCertifiable:
      break;
  }
  return statements;
}

template std::vector<ReportHead::Statement> fold_statements(const Evaluation<2>&,
                                                            const InvertibilityCertificate<2>&);
template std::vector<ReportHead::Statement> fold_statements(const Evaluation<3>&,
                                                            const InvertibilityCertificate<3>&);

}  // namespace crease
