#include "Applications/Report/ReportText.h"

#include <fmt/format.h>

#include <filesystem>

namespace crease {

std::string with_sign(const std::string& text) {
  return text.starts_with('-') ? "\u2212" + text.substr(1) : text;
}

std::string short_text(double value) { return with_sign(fmt::format("{:.4g}", value)); }

std::string count_text(std::int64_t count) {
  std::string text = std::to_string(count);
  for (int at = static_cast<int>(text.size()) - 3; at > 0; at -= 3) {
    text.insert(static_cast<std::size_t>(at), "\u202f");
  }
  return text;
}

std::string file_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

}  // namespace crease
