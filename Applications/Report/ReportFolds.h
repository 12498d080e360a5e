#pragma once

#include <vector>

#include "Applications/Report/HtmlReport.h"
#include "Registration/Evaluation.h"
#include "Transforms/InvertibilityCertificate.h"

namespace crease {

/// What the samples show of folds, and what is certified between them.
template <int Dim>
std::vector<ReportHead::Statement> fold_statements(
    const Evaluation<Dim>& evaluation, const InvertibilityCertificate<Dim>& certificate);

}  // namespace crease
