#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "Applications/Option.h"

namespace crease {

/// A key of a configuration file with its values as text.
struct ConfigEntry {
  std::string key;
  std::vector<std::string> values;
  int line = 0;
};

/// The entries of one section of a TOML file; sections of other subcommands are passed over.
///
///     [register]
///     fixed = "f.png"
///     no-creases = true
///     spacing = [0.5, 0.5]
///
/// @param sections  the names of all subcommands.
/// @throws UsageError when the file is missing, is not TOML, or holds a key outside a section, a section
/// that is not a subcommand, or a value that is not a text, number, truth value or list of these.
std::vector<ConfigEntry> read_config(const std::filesystem::path& file, const std::string& section,
                                     std::span<const std::string> sections);

/// One section that sets the options to the values they have now; read_config() gives them back exactly.
std::string write_config(const std::string& section, std::span<const Option> options);

}  // namespace crease
