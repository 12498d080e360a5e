#pragma once

#include <string>
#include <vector>

#include "Applications/Report/ReportFigures.h"

namespace crease {

/// What report.js needs to know of a page's figures, all but the pixels, as JSON that may stand in a script
/// element: `<` is written as an escape. Numbers are rounded to what can be seen.
std::string report_json(const std::vector<ReportStack>& stacks,
                        const std::vector<ReportViewer>& viewers,
                        const std::vector<ReportPlot>& plots);

}  // namespace crease
