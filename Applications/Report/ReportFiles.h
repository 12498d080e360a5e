#pragma once

#include <string_view>

namespace crease {

// report.html, report.css and report.js, as EmbedFiles.cmake puts them into the program.
extern const std::string_view kReportHtml, kReportCss, kReportJs;

}  // namespace crease
