#include "Applications/CommandLine.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <map>
#include <new>
#include <optional>

#include "Applications/ConfigFile.h"
#include "Applications/Spelling.h"

namespace crease {
namespace {

/// The texts that the command line gives for each option of one subcommand.
struct GivenValues {
  std::map<std::string, std::vector<std::string>> values;  // by option name
  std::string config_file;
};

bool takes_several(const Option& option) {
  return std::holds_alternative<std::vector<std::string>*>(option.target);
}

std::string flags_of(const Option& option) {
  if (option.positional) return option.name;
  return option.short_name.empty() ? "--" + option.name
                                   : "-" + option.short_name + ",--" + option.name;
}

/// "ssd|none", "moments|FILE", "MM".
std::string type_name_of(const Option& option) {
  std::string text;
  for (const std::string& choice : option.choices) text += (text.empty() ? "" : "|") + choice;
  if (!option.placeholder.empty()) text += (text.empty() ? "" : "|") + option.placeholder;
  return text;
}

void add_option(CLI::App& app, const Option& option, GivenValues& given) {
  const auto store = [&given, name = option.name](const CLI::results_t& results) {
    given.values[name] = results;
    return true;
  };
  if (std::holds_alternative<bool*>(option.target)) {
    auto* flag = app.add_flag(flags_of(option), option.help);
    flag->each(
        [&given, name = option.name](const std::string& value) { given.values[name] = {value}; });
    return;
  }
  auto* added = app.add_option(flags_of(option), store, option.help);
  added->type_name(type_name_of(option));
  added->default_str(default_text(option));
  if (takes_several(option)) added->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  if (option.required) added->description("(needed) " + option.help);
}

/// The parser of everything, and what it found.
class Parser {
 public:
  Parser(std::span<const Subcommand> subcommands, const std::string& version)
      : app_(
            "Registers images with splines that are smooth in soft tissue and creased along rigid "
            "bodies.",
            "crease"),
        subcommands_(subcommands),
        given_(subcommands.size()) {
    app_.set_version_flag("--version", version, "Print version, build, libraries and licence");
    app_.footer("Every subcommand explains itself: crease register --help");
    app_.allow_extras();
    app_.require_subcommand(0, 1);
    const auto format = std::make_shared<CLI::Formatter>();
    format->column_width(36);
    app_.formatter(format);
    app_.add_option("--config", config_file_, kConfigHelp)->type_name("FILE");
    for (std::size_t i = 0; i < subcommands.size(); ++i) {
      CLI::App& sub = *app_.add_subcommand(subcommands[i].name, subcommands[i].summary);
      sub.allow_extras();
      sub.footer(subcommands[i].details);
      for (const Option& option : subcommands[i].options) add_option(sub, option, given_[i]);
      sub.add_option("--config", given_[i].config_file, kConfigHelp)->type_name("FILE");
    }
  }

  /// The subcommand chosen; nullptr when help or version was printed instead.
  /// @throws UsageError.
  const Subcommand* parse(int argc, const char* const* argv) {
    try {
      app_.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
      std::cout << app_.help();
      return nullptr;
    } catch (const CLI::CallForVersion& call) {
      std::cout << call.what() << "\n";
      return nullptr;
    } catch (const CLI::ParseError& error) {
      throw UsageError(message(error.what(), " See crease --help."));
    }
    const auto chosen = app_.get_subcommands();
    if (chosen.empty()) refuse_without_subcommand();
    const auto found =
        std::ranges::find(subcommands_, chosen.front()->get_name(), &Subcommand::name);
    refuse_missing_values(*found);
    refuse_extras(*found);
    return &*found;
  }

  const GivenValues& given(const Subcommand& subcommand) const {
    return given_[static_cast<std::size_t>(&subcommand - subcommands_.data())];
  }
  /// The file of --config, before or after the subcommand; empty without one.
  std::string config_file(const Subcommand& subcommand) const {
    const std::string& after = given(subcommand).config_file;
    if (!after.empty() && !config_file_.empty()) throw UsageError("--config is given twice.");
    return after.empty() ? config_file_ : after;
  }

 private:
  static constexpr const char* kConfigHelp =
      "Read options from this TOML file; the command line wins";

  [[noreturn]] void refuse_without_subcommand() {
    std::vector<std::string> names;
    for (const Subcommand& subcommand : subcommands_) names.push_back(subcommand.name);
    const auto extras = app_.remaining();
    if (extras.empty()) {
      throw UsageError(
          message("nothing to do: name a subcommand, ", one_of(names), ". See crease --help."));
    }
    const std::string nearest = nearest_word(extras.front(), names);
    throw UsageError(message("\"", extras.front(), "\" is not a subcommand; ",
                             nearest.empty() ? "" : message("did you mean ", nearest, "? "),
                             "There are ", one_of(names), "."));
  }

  /// The parser takes whatever follows an option for its value.
  void refuse_missing_values(const Subcommand& subcommand) const {
    for (const auto& [name, values] : given(subcommand).values) {
      for (const std::string& value : values) {
        if (!value.starts_with("--")) continue;
        throw UsageError(
            message("--", name, " needs a value, but the option ", value, " follows."));
      }
    }
  }

  void refuse_extras(const Subcommand& subcommand) {
    const auto extras = app_.remaining(true);
    if (extras.empty()) return;
    const auto unknown = std::ranges::find_if(
        extras, [](const std::string& text) { return text.size() > 1 && text.front() == '-'; });
    if (unknown == extras.end()) {
      throw UsageError(message("the argument \"", extras.front(),
                               "\" does not belong to an option; write options as --name VALUE."));
    }
    std::vector<std::string> names = {"--config", "--help"};
    for (const Option& option : subcommand.options) names.push_back("--" + option.name);
    const std::string name = unknown->substr(0, unknown->find('='));
    const std::string nearest = nearest_word(name, names);
    throw UsageError(message("the option ", name, " is unknown",
                             nearest.empty() ? "" : message("; did you mean ", nearest, "?"),
                             nearest.empty() ? "; see" : " See", " crease ", subcommand.name,
                             " --help."));
  }

  CLI::App app_;
  std::span<const Subcommand> subcommands_;
  std::vector<GivenValues> given_;
  std::string config_file_;
};

/// The option of that name. @throws UsageError naming the nearest one.
const Option& find_option(const Subcommand& subcommand, const std::string& name,
                          const std::string& where) {
  std::vector<std::string> names;
  for (const Option& option : subcommand.options) {
    if (option.name == name) return option;
    names.push_back(option.name);
  }
  const std::string nearest = nearest_word(name, names);
  throw UsageError(message(where, ": the key ", name, " is unknown to crease ", subcommand.name,
                           nearest.empty() ? "" : message("; did you mean ", nearest, "?"),
                           nearest.empty() ? "." : ""));
}

/// Whether the command line names the option or one that excludes it.
bool overruled(const Subcommand& subcommand, const std::string& name, const GivenValues& given) {
  if (given.values.contains(name)) return true;
  return std::ranges::any_of(subcommand.exclusive, [&](const std::vector<std::string>& group) {
    return std::ranges::count(group, name) > 0 &&
           std::ranges::any_of(
               group, [&](const std::string& other) { return given.values.contains(other); });
  });
}

/// Sets the options' targets from the file and the command line.
void apply(const Subcommand& subcommand, const GivenValues& given,
           const std::vector<ConfigEntry>& entries, const std::string& config_file) {
  std::vector<std::string> set;
  for (const ConfigEntry& entry : entries) {
    const std::string line = message(config_file, ", line ", entry.line);
    const Option& option = find_option(subcommand, entry.key, line);
    if (overruled(subcommand, entry.key, given)) continue;
    assign(option, entry.values, message(line, ": ", entry.key));
    set.push_back(entry.key);
  }
  for (const Option& option : subcommand.options) {
    const auto values = given.values.find(option.name);
    if (values == given.values.end()) continue;
    assign(option, values->second, (option.positional ? "" : "--") + option.name);
    set.push_back(option.name);
  }
  for (const Option& option : subcommand.options) {
    if (option.required && std::ranges::count(set, option.name) == 0) {
      throw UsageError(message(option.positional ? "" : "--", option.name, " ", option.placeholder,
                               " is needed; see crease ", subcommand.name, " --help."));
    }
  }
  for (const auto& group : subcommand.exclusive) {
    std::vector<std::string> both;
    for (const std::string& name : group) {
      if (std::ranges::count(set, name) > 0) both.push_back(name);
    }
    if (both.size() > 1) {
      throw UsageError(
          message("--", both[0], " and --", both[1], " exclude each other; give one."));
    }
  }
}

ExitCode parse_and_run(int argc, const char* const* argv, std::span<const Subcommand> subcommands,
                       const std::string& version) {
  Parser parser(subcommands, version);
  const Subcommand* subcommand = parser.parse(argc, argv);
  if (subcommand == nullptr) return ExitCode::kSuccess;
  std::vector<std::string> names;
  for (const Subcommand& known : subcommands) names.push_back(known.name);
  const std::string file = parser.config_file(*subcommand);
  std::vector<ConfigEntry> entries;
  if (!file.empty()) entries = read_config(file, subcommand->name, names);
  apply(*subcommand, parser.given(*subcommand), entries, file);
  return subcommand->run(write_config(subcommand->name, subcommand->options));
}

/// "crease register" when the command line names a subcommand, else "crease".
std::string command_name(int argc, const char* const* argv,
                         std::span<const Subcommand> subcommands) {
  for (int i = 1; i < argc; ++i) {
    if (std::ranges::count(subcommands, argv[i], &Subcommand::name) > 0) {
      return std::string("crease ") + argv[i];
    }
  }
  return "crease";
}

}  // namespace

int run_command(int argc, const char* const* argv, std::span<const Subcommand> subcommands,
                const std::string& version) {
  const auto fail = [&](ExitCode code, const std::string& what) {
    std::cout.flush();
    std::cerr << command_name(argc, argv, subcommands) << ": " << what << std::endl;
    return static_cast<int>(code);
  };
  try {
    return static_cast<int>(parse_and_run(argc, argv, subcommands, version));
  } catch (const UsageError& error) {
    return fail(ExitCode::kUsage, error.what());
  } catch (const SolverError& error) {
    return fail(ExitCode::kNotConverged, error.what());
  } catch (const Error& error) {
    return fail(ExitCode::kBadData, error.what());
  } catch (const std::bad_alloc&) {
    return fail(ExitCode::kOutOfResources,
                "out of memory; use smaller images, a larger --mesh-size, or a larger machine.");
  } catch (const std::exception& error) {
    return fail(ExitCode::kInternalError, message("internal error: ", error.what(),
                                                  ". Please report it with the command line."));
  }
}

}  // namespace crease
