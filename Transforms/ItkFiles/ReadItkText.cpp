#include <charconv>
#include <fstream>
#include <iterator>
#include <string_view>

#include "Core/Error.h"
#include "Transforms/ItkFiles/ReadItkFile.h"

namespace crease {
namespace {

/// Takes such a file apart, line by line:
///
///     #Insight Transform File V1.0
///     #Transform 0
///     Transform: AffineTransform_double_2_2
///     Parameters: 1 0 0 1 5 0
///     FixedParameters: 0 0
class TextReader {
 public:
  explicit TextReader(const std::filesystem::path& file) : file_(file.string()) {
    std::ifstream stream(file, std::ios::binary);
    text_.assign(std::istreambuf_iterator<char>(stream), {});
  }

  std::vector<ItkTransform> read() {
    check_form();
    for (std::size_t at = 0; at < text_.size();) {
      const std::size_t end = text_.find('\n', at);
      ++line_;
      read_line(trimmed(std::string_view(text_).substr(at, end - at)));
      at = end + 1;
    }
    if (transforms_.empty()) fail("holds no transform");
    return std::move(transforms_);
  }

 private:
  void check_form() const {
    constexpr std::string_view kMark = "#Insight Transform File";
    if (!text_.starts_with(kMark)) {
      if (text_.find("(Transform \"") != std::string::npos) {
        fail(
            "is a parameter file of elastix; let elastix write ITK's form, by "
            "-itkTransformOutputFileNameExtension "
            "tfm, and take that file");
      }
      fail(message("is not a transform file of ITK: it does not begin with \"", kMark, "\""));
    }
    if (text_.back() != '\n') {
      fail("ends within a line, so it may be cut off; if it is whole, add a line break at its end");
    }
  }

  void read_line(std::string_view line) {
    if (line.empty() || line.front() == '#') return;
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) fail_line("has no colon");
    const std::string_view label = trimmed(line.substr(0, colon));
    const std::string_view rest = trimmed(line.substr(colon + 1));
    if (label == "Transform") {
      transforms_.push_back({std::string(rest), {}, {}});
    } else if (label == "Parameters" || label == "FixedParameters") {
      if (transforms_.empty()) fail_line("comes before the first \"Transform:\"");
      auto& transform = transforms_.back();
      (label == "Parameters" ? transform.parameters : transform.fixed_parameters) = numbers(rest);
    } else if (label == "ComponentTransformFile") {
      fail_line("names another file; give that one as a --transform of its own");
    } else {
      fail_line(message("begins with \"", label, "\", which is unknown"));
    }
  }

  Eigen::VectorXd numbers(std::string_view text) const {
    std::vector<double> values;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (true) {
      while (at != end && is_space(*at)) ++at;
      if (at == end) break;
      double value = 0;
      const auto [next, error] = std::from_chars(at, end, value);
      if (error != std::errc() || (next != end && !is_space(*next))) {
        const std::string_view rest(at, static_cast<std::size_t>(end - at));
        fail_line(message("has \"", rest.substr(0, rest.find_first_of(" \t")), "\" as number ",
                          values.size() + 1));
      }
      values.push_back(value);
      at = next;
    }
    return Eigen::Map<const Eigen::VectorXd>(values.data(), std::ssize(values));
  }

  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }
  static std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    return text;
  }
  [[noreturn]] void fail_line(const std::string& what) const {
    throw FileError(message(file_, ", line ", line_, ": ", what, "."));
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw FileError(message(file_, ": ", what, "."));
  }

  std::string file_, text_;
  int line_ = 0;
  std::vector<ItkTransform> transforms_;
};

}  // namespace

std::vector<ItkTransform> read_itk_text(const std::filesystem::path& file) {
  return TextReader(file).read();
}

}  // namespace crease
