#include "Applications/Option.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "Applications/ExitCode.h"
#include "Applications/Spelling.h"

namespace crease {
namespace {

template <typename... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <typename... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

std::string range_text(const Option& option) {
  const bool below = std::isfinite(option.minimum), above = std::isfinite(option.maximum);
  if (below && above) {
    return message(option.open_minimum ? "above " : "from ", option.minimum,
                   option.open_minimum ? " and up to " : " to ", option.maximum);
  }
  if (below) return message(option.open_minimum ? "above " : "of at least ", option.minimum);
  if (above) return message("up to ", option.maximum);
  return "";
}

[[noreturn]] void refuse(const Option& option, const std::string& where, const std::string& value,
                         const char* kind) {
  const std::string range = range_text(option);
  throw UsageError(
      message(where, ": \"", value, "\" is not a ", kind, range.empty() ? "" : " ", range, "."));
}

/// The whole text as a number within the option's range.
template <typename Number>
Number parse_number(const Option& option, const std::string& where, const std::string& text) {
  const char* kind = std::is_integral_v<Number> ? "whole number" : "number";
  Number value{};
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || last != end || !std::isfinite(static_cast<double>(value))) {
    refuse(option, where, text, kind);
  }
  if (value < option.minimum || value > option.maximum ||
      (option.open_minimum && value == option.minimum)) {
    refuse(option, where, text, kind);
  }
  return value;
}

bool is_choice(const Option& option, const std::string& text) {
  return std::ranges::count(option.choices, text) > 0;
}

std::string parse_text(const Option& option, const std::string& where, const std::string& text) {
  if (text.empty()) throw UsageError(message(where, ": the value is empty."));
  if (option.choices.empty() || is_choice(option, text)) return text;
  if (option.is_path && std::filesystem::exists(text)) return text;
  const std::string nearest = nearest_word(text, option.choices);
  throw UsageError(message(where, ": \"", text, "\" is unknown; ",
                           nearest.empty() ? "" : message("did you mean ", nearest, "? "),
                           "It takes ", one_of(option.choices),
                           option.is_path ? ", or a file that exists." : "."));
}

bool parse_flag(const std::string& where, const std::string& text) {
  if (text == "true") return true;
  if (text == "false") return false;
  throw UsageError(message(where, ": \"", text, "\" is not true or false."));
}

std::vector<std::string> split_at_commas(std::span<const std::string> values) {
  std::vector<std::string> parts;
  for (const std::string& value : values) {
    std::size_t begin = 0;
    for (std::size_t comma; (comma = value.find(',', begin)) != std::string::npos;
         begin = comma + 1) {
      parts.push_back(value.substr(begin, comma - begin));
    }
    parts.push_back(value.substr(begin));
  }
  return parts;
}

std::string saved_text(const Option& option, const std::string& text) {
  if (!option.is_path || is_choice(option, text)) return text;
  return std::filesystem::absolute(text).lexically_normal().string();
}

}  // namespace

void assign(const Option& option, std::span<const std::string> values, const std::string& where) {
  const auto single = [&]() -> const std::string& {
    if (values.size() != 1) {
      throw UsageError(message(where, ": takes one value, not ", values.size(), "."));
    }
    return values.front();
  };
  std::visit(
      Overloaded{
          [&](bool* target) { *target = parse_flag(where, single()); },
          [&](int* target) { *target = parse_number<int>(option, where, single()); },
          [&](double* target) { *target = parse_number<double>(option, where, single()); },
          [&](std::string* target) { *target = parse_text(option, where, single()); },
          [&](std::optional<int>* target) { *target = parse_number<int>(option, where, single()); },
          [&](std::optional<double>* target) {
            *target = parse_number<double>(option, where, single());
          },
          [&](std::optional<std::string>* target) {
            *target = parse_text(option, where, single());
          },
          [&](std::vector<double>* target) {
            target->clear();
            for (const std::string& part : split_at_commas(values)) {
              target->push_back(parse_number<double>(option, where, part));
            }
          },
          [&](std::vector<std::string>* target) {
            target->clear();
            for (const std::string& value : values) {
              target->push_back(parse_text(option, where, value));
            }
          },
      },
      option.target);
}

std::optional<ConfigValue> current_value(const Option& option) {
  using Result = std::optional<ConfigValue>;
  return std::visit(
      Overloaded{
          [](bool* value) { return Result(*value); },
          [](int* value) { return Result(std::int64_t{*value}); },
          [](double* value) { return Result(*value); },
          [&](std::string* value) {
            return value->empty() ? Result() : Result(saved_text(option, *value));
          },
          [](std::optional<int>* value) {
            return *value ? Result(std::int64_t{**value}) : Result();
          },
          [](std::optional<double>* value) { return *value ? Result(**value) : Result(); },
          [&](std::optional<std::string>* value) {
            return *value ? Result(saved_text(option, **value)) : Result();
          },
          [](std::vector<double>* value) { return value->empty() ? Result() : Result(*value); },
          [&](std::vector<std::string>* value) {
            if (value->empty()) return Result();
            if (value->size() == 1) return Result(saved_text(option, value->front()));
            std::vector<std::string> texts;
            for (const std::string& text : *value) texts.push_back(saved_text(option, text));
            return Result(texts);
          },
      },
      option.target);
}

std::string default_text(const Option& option) {
  return std::visit(Overloaded{
                        [](int* value) { return message(*value); },
                        [](double* value) { return message(*value); },
                        [](std::string* value) { return *value; },
                        [](std::vector<std::string>* value) {
                          return value->empty() ? std::string() : value->front();
                        },
                        [](auto*) { return std::string(); },
                    },
                    option.target);
}

std::vector<Option> joined(std::initializer_list<std::vector<Option>> parts) {
  std::vector<Option> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace crease
