#include "Applications/ConfigFile.h"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <sstream>

#include "Applications/ExitCode.h"
#include "Applications/Spelling.h"

namespace crease {
namespace {

/// Shortest text that reads back as the same number.
std::string number_text(double value) {
  std::array<char, 32> buffer;
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

std::string scalar_text(const toml::node& node, const std::string& where) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* integer = node.as_integer()) return std::to_string(integer->get());
  if (const auto* number = node.as_floating_point()) return number_text(number->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  throw UsageError(message(where,
                           ": the value must be a text in quotes, a number, true or false, or a "
                           "list of these."));
}

ConfigEntry read_entry(const std::string& file, const std::string& key, const toml::node& node) {
  ConfigEntry entry{.key = key, .values = {}, .line = static_cast<int>(node.source().begin.line)};
  const std::string where = message(file, ", line ", entry.line, ": ", key);
  if (const auto* list = node.as_array()) {
    for (const toml::node& element : *list) entry.values.push_back(scalar_text(element, where));
  } else {
    entry.values.push_back(scalar_text(node, where));
  }
  return entry;
}

toml::table parse_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream || !std::filesystem::is_regular_file(file)) {
    throw UsageError(message("--config ", file.string(), ": the file cannot be read."));
  }
  try {
    return toml::parse(text.str());
  } catch (const toml::parse_error& error) {
    throw UsageError(message("--config ", file.string(), ", line ", error.source().begin.line, ": ",
                             error.description(), "."));
  }
}

/// A section of the file written so that single-line values stay on one line each.
toml::array to_array(const auto& values) {
  toml::array array;
  for (const auto& value : values) array.push_back(value);
  return array;
}

}  // namespace

std::vector<ConfigEntry> read_config(const std::filesystem::path& file, const std::string& section,
                                     std::span<const std::string> sections) {
  const toml::table content = parse_file(file);
  std::vector<ConfigEntry> entries;
  for (const auto& [key, node] : content) {
    const std::string name(key.str());
    const std::string where = message(file.string(), ", line ", node.source().begin.line);
    const toml::table* table = node.as_table();
    if (table == nullptr) {
      throw UsageError(
          message(where, ": ", name, " stands outside a section; put it below [", section, "]."));
    }
    if (std::ranges::count(sections, name) == 0) {
      const std::string nearest = nearest_word(name, sections);
      throw UsageError(message(where, ": the section [", name, "] is unknown; ",
                               nearest.empty() ? "" : message("did you mean [", nearest, "]? "),
                               "The sections are ", one_of(sections), "."));
    }
    if (name != section) continue;
    for (const auto& [option, value] : *table) {
      entries.push_back(read_entry(file.string(), std::string(option.str()), value));
    }
  }
  std::ranges::sort(entries, {}, &ConfigEntry::line);
  return entries;
}

std::string write_config(const std::string& section, std::span<const Option> options) {
  std::ostringstream text;
  text << "[" << section << "]\n";
  for (const Option& option : options) {
    const auto value = current_value(option);
    if (!option.affects_results || !value) continue;
    text << option.name << " = ";
    std::visit(
        [&](const auto& content) {
          using Content = std::decay_t<decltype(content)>;
          if constexpr (std::is_same_v<Content, std::vector<double>> ||
                        std::is_same_v<Content, std::vector<std::string>>) {
            text << to_array(content);
          } else {
            text << toml::value<Content>(content);
          }
        },
        *value);
    text << "\n";
  }
  return text.str();
}

}  // namespace crease
