#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace crease {

/// Where an option's value goes, and thereby what it takes. An empty std::optional or vector means that
/// the option was not given.
using OptionTarget =
    std::variant<bool*, int*, double*, std::string*, std::optional<int>*, std::optional<double>*,
                 std::optional<std::string>*, std::vector<double>*, std::vector<std::string>*>;

/// One option of a subcommand. Its name, without dashes, is also its key in a configuration file.
struct Option {
  std::string name;
  OptionTarget target;
  std::string placeholder = {};  ///< what the help calls the value: "FILE", "MM"
  std::string help = {};
  std::vector<std::string> choices = {};                      ///< of a text; empty: any
  double minimum = -std::numeric_limits<double>::infinity();  ///< of numbers, itself allowed
  double maximum = std::numeric_limits<double>::infinity();
  bool open_minimum = false;  ///< the minimum itself is not allowed
  bool required = false;
  bool is_path = false;         ///< a file or folder, saved with its absolute path
  bool positional = false;      ///< given without its name
  bool affects_results = true;  ///< false: left out of the configuration that a run writes
  std::string short_name = {};  ///< one letter, or none
};

/// A value as a configuration file writes it.
using ConfigValue = std::variant<bool, std::int64_t, double, std::string, std::vector<double>,
                                 std::vector<std::string>>;

/// Sets the option's target.
/// @param values  as they were typed: one; several for vectors, which also split numbers at commas.
/// @param where   how messages name the option: "--degree", "run.toml, line 3: degree".
/// @throws UsageError when a value cannot be read or is out of range.
void assign(const Option& option, std::span<const std::string> values, const std::string& where);

/// The value as it stands, default or not; nothing when the option was not given and has no default.
/// Paths are made absolute.
std::optional<ConfigValue> current_value(const Option& option);

/// The default as the help shows it; empty when there is none.
std::string default_text(const Option& option);

/// All of these, in order.
std::vector<Option> joined(std::initializer_list<std::vector<Option>> parts);

}  // namespace crease
