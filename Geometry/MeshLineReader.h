#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "Core/Error.h"
#include "Core/Point.h"

namespace crease {

/// The lines of a mesh file, word by word. All functions throw InvalidInput naming file, line and what is
/// wrong; the constructor FileError.
class LineReader {
 public:
  /// @param comment  what begins a comment; 0: nothing does.
  LineReader(const std::filesystem::path& path, char comment)
      : path_(path), comment_(comment), stream_(path) {
    if (!stream_ || std::filesystem::is_directory(path)) {
      throw FileError(message(path.string(), ": the file cannot be read"));
    }
  }
  /// Goes to the next line that is not empty. @return false at the end of the file.
  bool next() {
    for (std::string line; std::getline(stream_, line);) {
      ++number_;
      if (comment_ != 0) line.erase(std::min(line.size(), line.find(comment_)));
      words_.clear();
      for (std::size_t begin = 0; begin < line.size();) {
        const auto from = line.find_first_not_of(" \t\r", begin);
        if (from == std::string::npos) break;
        begin = std::min(line.size(), line.find_first_of(" \t\r", from));
        words_.push_back(line.substr(from, begin - from));
      }
      if (!words_.empty()) return true;
    }
    words_.clear();
    return false;
  }
  void require_next(const char* what) {
    if (!next()) {
      throw InvalidInput(
          message(path_.string(), ": the file ends before ", what, "; it may be cut off"));
    }
  }
  /// What follows the current line, as it is.
  std::string rest() { return {std::istreambuf_iterator<char>(stream_), {}}; }
  [[noreturn]] void fail(const std::string& what) const {
    throw InvalidInput(message(path_.string(), ", line ", number_, ": ", what));
  }
  std::size_t num_words() const { return words_.size(); }
  const std::string& word(std::size_t i) const {
    if (i >= words_.size()) fail(message("there is no word ", i + 1));
    return words_[i];
  }
  template <typename Number>
  Number number(std::size_t i) const {
    return parse<Number>(word(i));
  }
  template <typename Number>
  Number parse(std::string_view text) const {
    Number value{};
    const char* end = text.data() + text.size();
    const auto [last, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || last != end) fail(message("\"", text, "\" is not a number"));
    return value;
  }
  int count(std::size_t i) const {
    const int value = number<int>(i);
    if (value < 0) fail(message("a count of ", value));
    return value;
  }
  Point<3> point(std::array<std::size_t, 3> columns) const {
    Point<3> p(number<double>(columns[0]), number<double>(columns[1]), number<double>(columns[2]));
    if (!p.allFinite()) fail("the vertex is not finite");
    return p;
  }

 private:
  const std::filesystem::path& path_;
  char comment_;
  std::ifstream stream_;
  int number_ = 0;
  std::vector<std::string> words_;
};

/// Refuses a face with too few vertices or ones that do not exist.
inline void check_face(const LineReader& reader, const std::vector<int>& face,
                       std::size_t num_vertices) {
  if (face.size() < 3)
    reader.fail(message("a face of ", face.size(), " vertices; three are needed"));
  for (int v : face) {
    if (v < 0 || v >= static_cast<int>(num_vertices)) {
      reader.fail(message("a face names vertex ", v, " (from 0), but there are ", num_vertices));
    }
  }
}

/// `count` and that many vertex numbers from word `first` on.
inline std::vector<int> counted_face(const LineReader& reader, std::size_t first) {
  const auto count = static_cast<std::size_t>(reader.count(first));
  if (reader.num_words() < first + 1 + count) {
    reader.fail(
        message("a face of ", count, " vertices names only ", reader.num_words() - first - 1));
  }
  std::vector<int> face(count);
  for (std::size_t k = 0; k < face.size(); ++k) face[k] = reader.number<int>(first + 1 + k);
  return face;
}

}  // namespace crease
