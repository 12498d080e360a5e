#include "Applications/FileInfo.h"

#include <fmt/format.h>

namespace crease {

std::string numbers_text(const double* values, int count, const char* separator) {
  std::string text;
  for (int a = 0; a < count; ++a) {
    text += fmt::format("{}{:.6g}", a > 0 ? separator : "", values[a]);
  }
  return text;
}

}  // namespace crease
