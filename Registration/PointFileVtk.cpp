#include "Registration/PointFileVtk.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <sstream>

#include "Core/Error.h"

namespace crease {
namespace {

/// Goes through the file's bytes.
class Scanner {
 public:
  explicit Scanner(const std::filesystem::path& path) : file_(path.string()) {
    std::ifstream stream(path, std::ios::binary);
    if (!stream || std::filesystem::is_directory(path)) fail("cannot be opened; check the name");
    bytes_.assign(std::istreambuf_iterator<char>(stream), {});
  }

  std::string line() {
    if (at_ >= bytes_.size()) fail("ends within its header; it may be cut off");
    const std::size_t end = std::min(bytes_.size(), bytes_.find('\n', at_));
    std::string text = bytes_.substr(at_, end - at_);
    at_ = std::min(bytes_.size(), end + 1);
    if (!text.empty() && text.back() == '\r') text.pop_back();
    return text;
  }
  double number() {
    while (at_ < bytes_.size() && std::isspace(static_cast<unsigned char>(bytes_[at_]))) ++at_;
    double value = 0;
    const auto [end, error] =
        std::from_chars(bytes_.data() + at_, bytes_.data() + bytes_.size(), value);
    if (error != std::errc())
      fail(message("has no number at byte ", at_ + 1, "; it may be cut off"));
    at_ = static_cast<std::size_t>(end - bytes_.data());
    return value;
  }
  /// The high byte first.
  template <typename Bits, typename Number>
  double binary_number() {
    skip(sizeof(Bits));
    Bits bits = 0;
    for (std::size_t k = sizeof(Bits); k > 0; --k) {
      bits = bits << 8 | static_cast<std::uint8_t>(bytes_[at_ - k]);
    }
    return std::bit_cast<Number>(bits);
  }
  void skip(std::size_t count) {
    if (bytes_.size() - at_ < count) fail("is cut off");
    at_ += count;
  }
  std::size_t at() const { return at_; }
  std::string before(std::size_t end) const { return bytes_.substr(0, end); }
  std::string rest() const { return bytes_.substr(at_); }
  [[noreturn]] void fail(const std::string& what) const {
    throw InvalidInput(message(file_, ": ", what, "."));
  }

 private:
  std::string file_, bytes_;
  std::size_t at_ = 0;
};

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  const std::istream_iterator<std::string> begin(stream), end;
  return {begin, end};
}

std::size_t count_of(const Scanner& scanner, const std::string& word) {
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  if (error != std::errc() || end != word.data() + word.size() || count > 1'000'000'000) {
    scanner.fail(message("has \"", word, "\" where a count should be"));
  }
  return count;
}

std::size_t width_of(const Scanner& scanner, const std::string& type) {
  if (type == "double" || type == "long" || type == "unsigned_long" || type == "vtktypeint64" ||
      type == "vtkIdType") {
    return 8;
  }
  if (type == "float" || type == "int" || type == "unsigned_int") return 4;
  if (type == "short" || type == "unsigned_short") return 2;
  if (type == "char" || type == "unsigned_char") return 1;
  scanner.fail(message("has numbers of the type \"", type, "\", which is not read"));
}

/// "FIELD name n" and its n arrays "name components tuples type", which may stand before the points.
void skip_field(Scanner& scanner, const std::vector<std::string>& words, bool binary) {
  const std::size_t arrays = words.size() > 2 ? count_of(scanner, words[2]) : 0;
  for (std::size_t k = 0; k < arrays; ++k) {
    auto array = words_of(scanner.line());
    while (array.empty() || array[0] == "METADATA") {
      while (!array.empty()) array = words_of(scanner.line());  // until an empty line
      array = words_of(scanner.line());
    }
    if (array.size() != 4) scanner.fail("has a field array without name, two counts and type");
    const std::size_t count = count_of(scanner, array[1]) * count_of(scanner, array[2]);
    if (binary) {
      scanner.skip(count * width_of(scanner, array[3]));
    } else {
      for (std::size_t n = 0; n < count; ++n) scanner.number();
    }
    if (count > 0) scanner.line();
  }
}

void append_binary(std::string& text, double number) {
  const auto bits = std::bit_cast<std::uint64_t>(number);
  for (int k = 7; k >= 0; --k) text += static_cast<char>(bits >> (8 * k) & 0xff);
}

}  // namespace

VtkPoints::VtkPoints(const std::filesystem::path& path) {
  Scanner scanner(path);
  if (!scanner.line().starts_with("# vtk DataFile")) {
    scanner.fail("is not a legacy VTK file: it does not begin with \"# vtk DataFile\"");
  }
  ras_ = scanner.line().find("SPACE=RAS") != std::string::npos;
  const auto form = words_of(scanner.line());
  if (form.size() != 1 || (form[0] != "ASCII" && form[0] != "BINARY")) {
    scanner.fail("says neither ASCII nor BINARY in its third line");
  }
  binary_ = form[0] == "BINARY";
  std::size_t start = 0;
  std::vector<std::string> words;
  while (words.empty() || words[0] != "POINTS") {
    if (words.size() > 1 && words[0] == "FIELD") skip_field(scanner, words, binary_);
    start = scanner.at();
    words = words_of(scanner.line());
    const bool known = words.empty() || words[0] == "POINTS" || words[0] == "DATASET" ||
                       words[0] == "DIMENSIONS" || words[0] == "FIELD";
    if (!known) scanner.fail(message("has no POINTS before \"", words[0], "\""));
  }
  if (words.size() != 3) scanner.fail("does not tell count and type of its POINTS");
  const std::size_t count = count_of(scanner, words[1]);
  const std::size_t width = width_of(scanner, words[2]);
  if (binary_ && words[2] != "float" && words[2] != "double") {
    scanner.fail(
        message("has binary POINTS of the type ", words[2], "; float and double are read"));
  }
  for (std::size_t k = 0; k < count; ++k) {
    Point<3> p;
    for (double& c : p) {
      c = !binary_     ? scanner.number()
          : width == 8 ? scanner.binary_number<std::uint64_t, double>()
                       : scanner.binary_number<std::uint32_t, float>();
    }
    if (!p.allFinite()) scanner.fail(message("has a point ", k, " that is not finite"));
    points_.push_back(turned(p, ras_));
  }
  if (points_.empty()) scanner.fail("holds no point");
  before_ = scanner.before(start);
  after_ = scanner.rest();
}

std::string VtkPoints::with_points(const std::vector<Point<3>>& points) const {
  std::string text = message(before_, "POINTS ", points.size(), " double\n");
  std::ostringstream stream;
  stream.precision(17);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Point<3> p = turned(points[k], ras_);
    if (!binary_) stream << (k > 0 ? "\n" : "") << p[0] << ' ' << p[1] << ' ' << p[2];
    if (binary_) {
      for (const double c : p) append_binary(text, c);
    }
  }
  return text + stream.str() + after_;
}

}  // namespace crease
