#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "Core/Error.h"
#include "Core/Point.h"

namespace crease {

/// One value of a JSON file that knows its place in it, so that every complaint names the file and the
/// entry at fault. All functions throw FileError. For .cpp files: nlohmann's header is heavy.
class JsonReader {
 public:
  JsonReader(const nlohmann::json& value, std::string file, std::string place = "")
      : value_(value), file_(std::move(file)), place_(std::move(place)) {}

  bool has(const std::string& key) const { return value_.is_object() && value_.contains(key); }
  JsonReader at(const std::string& key) const {
    if (!has(key)) fail(message("the entry \"", inner(key), "\" is missing"));
    return {value_.at(key), file_, inner(key)};
  }
  JsonReader at(std::size_t index) const {
    return {value_.at(index), file_, message(place_, "[", index, "]")};
  }
  std::size_t size() const {
    if (!value_.is_array()) fail_here("is not a list");
    return value_.size();
  }

  std::string text() const {
    if (!value_.is_string()) fail_here("is not a text");
    return value_.get<std::string>();
  }
  bool flag() const {
    if (!value_.is_boolean()) fail_here("is not true or false");
    return value_.get<bool>();
  }
  int integer(int least, int greatest) const {
    if (!value_.is_number_integer()) fail_here("is not an integer");
    const auto number = value_.get<std::int64_t>();
    if (number < least || number > greatest) {
      fail_here(message("is ", number, "; it must be ", least, " to ", greatest));
    }
    return static_cast<int>(number);
  }
  double number() const {
    if (!value_.is_number()) fail_here("is not a number");
    return value_.get<double>();
  }
  /// A list of exactly Rows * Cols numbers, column by column; Cols may be Eigen::Dynamic with `columns`.
  template <int Rows, int Cols = 1>
  Matrix<Rows, Cols> numbers(Eigen::Index columns = Cols) const {
    Matrix<Rows, Cols> result(Rows, columns);
    if (static_cast<Eigen::Index>(size()) != result.size()) {
      fail_here(message("has ", size(), " numbers instead of ", result.size()));
    }
    for (Eigen::Index n = 0; n < result.size(); ++n) {
      const auto& entry = value_[static_cast<std::size_t>(n)];
      result.data()[n] =
          entry.is_number() ? entry.get<double>() : at(static_cast<std::size_t>(n)).number();
    }
    return result;
  }

  /// "the entry "place" <what>": for what is wrong with this value.
  [[noreturn]] void fail_here(const std::string& what) const {
    fail(message("the entry \"", place_, "\" ", what));
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw FileError(message(file_, ": ", what, "."));
  }

 private:
  std::string inner(const std::string& key) const {
    return place_.empty() ? key : place_ + "." + key;
  }

  const nlohmann::json& value_;
  std::string file_;
  std::string place_;
};

}  // namespace crease
