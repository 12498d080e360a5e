#include <array>
#include <bit>
#include <cstdint>
#include <fstream>
#include <iterator>

#include "Core/Error.h"
#include "Transforms/ItkFiles/ReadItkFile.h"

namespace crease {
namespace {

/// Matlab 4: matrices one after the other, each with a header of five 32-bit integers (type, rows,
/// columns, imaginary part or not, length of the name), its name, and its numbers. ITK writes two for a
/// transform: the parameters, named as the class, and the fixed parameters, named "fixed".
///
/// The type's decimal digits: thousands 0 little, 1 big endian; hundreds 0 (1 for VXL's files by rows,
/// which is the same for vectors); tens 0 double, 1 single precision; ones 0 numbers.
class MatlabReader {
 public:
  explicit MatlabReader(const std::filesystem::path& file) : file_(file.string()) {
    std::ifstream stream(file, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(stream), {});
  }

  std::vector<ItkTransform> read() {
    std::vector<ItkTransform> transforms;
    while (at_ < bytes_.size()) {
      Entry entry = next();
      if (entry.name != "fixed") {
        transforms.push_back({entry.name, {}, std::move(entry.numbers)});
      } else if (transforms.empty()) {
        fail("begins with fixed parameters instead of a transform");
      } else {
        transforms.back().fixed_parameters = std::move(entry.numbers);
      }
    }
    return transforms;
  }

 private:
  struct Entry {
    std::string name;
    Eigen::VectorXd numbers;
  };

  Entry next() {
    const std::array<std::uint32_t, 5> header = read_header();
    const auto [type, rows, columns, imaginary, name_length] = header;
    const std::uint32_t precision = type / 10 % 10;
    if (type > 1110 || type % 10 != 0 || type / 100 % 10 > 1 || precision > 1 || imaginary != 0 ||
        name_length < 2 || name_length > 256 || (rows != 0 && columns > 0xffffffffU / rows)) {
      fail("is no file of Matlab 4 with real numbers, as ITK and ANTs write transforms");
    }
    require(name_length);
    Entry entry;
    entry.name = bytes_.substr(at_, name_length - 1);  // a zero ends it
    at_ += name_length;
    const std::size_t count = std::size_t{rows} * columns, width = precision == 0 ? 8 : 4;
    require(count * width);
    entry.numbers.resize(static_cast<Eigen::Index>(count));
    for (double& number : entry.numbers) {
      number = precision == 0 ? std::bit_cast<double>(integer<std::uint64_t>())
                              : std::bit_cast<float>(integer<std::uint32_t>());
    }
    return entry;
  }

  std::array<std::uint32_t, 5> read_header() {
    require(20);
    std::array<std::uint32_t, 5> header;
    // The type is at most 1110, so that its upper half is 0: that tells the order of the bytes.
    big_endian_ =
        bytes_[at_] == 0 && bytes_[at_ + 1] == 0 && (bytes_[at_ + 2] != 0 || bytes_[at_ + 3] != 0);
    for (auto& number : header) number = integer<std::uint32_t>();
    if ((header[0] >= 1000) != big_endian_) {
      fail("is no file of Matlab 4 with numbers in the order of bytes that it names");
    }
    return header;
  }

  template <typename Bits>
  Bits integer() {
    Bits bits = 0;
    for (std::size_t k = 0; k < sizeof(Bits); ++k) {
      const std::size_t byte = big_endian_ ? k : sizeof(Bits) - 1 - k;
      bits = bits << 8 | static_cast<std::uint8_t>(bytes_[at_ + byte]);
    }
    at_ += sizeof(Bits);
    return bits;
  }
  void require(std::size_t count) const {
    if (bytes_.size() - at_ < count) fail("is cut off");
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw FileError(message(file_, ": ", what, "."));
  }

  std::string file_, bytes_;
  std::size_t at_ = 0;
  bool big_endian_ = false;
};

}  // namespace

std::vector<ItkTransform> read_itk_matlab(const std::filesystem::path& file) {
  return MatlabReader(file).read();
}

}  // namespace crease
