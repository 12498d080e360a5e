#include "Images/Files/TextHeader.h"

#include <sstream>

namespace crease {

std::optional<std::string_view> next_line(std::string_view text, std::size_t& at) {
  const auto end = text.find('\n', at);
  if (end == std::string_view::npos) return std::nullopt;
  std::string_view line = text.substr(at, end - at);
  if (line.ends_with('\r')) line.remove_suffix(1);
  at = end + 1;
  return line;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const auto first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

std::string value_of(const HeaderFields& fields, std::string_view key, const char* otherwise) {
  const auto found = fields.find(key);
  return found == fields.end() ? otherwise : found->second;
}

std::uint64_t count_words(std::string_view text, std::uint64_t limit) {
  std::uint64_t count = 0;
  bool inside = false;
  for (const char c : text) {
    const bool space = c == ' ' || c == '\t' || c == '\r' || c == '\n';
    if (!space && !inside && ++count >= limit) return count;
    inside = !space;
  }
  return count;
}

std::uint64_t product_of_sizes(std::string_view text) {
  std::istringstream stream{std::string(text)};
  std::uint64_t product = 1;
  for (double size; stream >> size;) {
    if (!(size >= 1) || size > 1e9 || static_cast<double>(product) * size > 1e15) return 0;
    product *= static_cast<std::uint64_t>(size);
  }
  return stream.eof() ? product : 0;
}

}  // namespace crease
