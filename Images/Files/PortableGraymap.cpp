#include "Images/Files/PortableGraymap.h"

#include <algorithm>
#include <fstream>

#include "Core/Error.h"
#include "Images/Files/FileBytes.h"

namespace crease {
namespace {

/// Whole numbers of a PGM file, with comments from # to the end of a line between them.
class NumberReader {
 public:
  NumberReader(const std::filesystem::path& path, Bytes bytes, std::size_t at)
      : path_(path), bytes_(bytes), at_(at) {}

  int next(int largest, const char* what) {
    skip_space();
    std::int64_t value = 0;
    const std::size_t first = at_;
    for (; at_ < bytes_.size() && bytes_[at_] >= '0' && bytes_[at_] <= '9'; ++at_) {
      value = value * 10 + (bytes_[at_] - '0');
      if (value > largest) fail(path_, message("the ", what, " of the PGM file is too large"));
    }
    if (at_ == first) {
      fail(path_, message("the ", what, " of the PGM file is ",
                          at_ < bytes_.size() ? "no number" : "missing: the file is truncated"));
    }
    return static_cast<int>(value);
  }
  std::size_t position() const { return at_; }

 private:
  void skip_space() {
    while (at_ < bytes_.size()) {
      const auto c = bytes_[at_];
      if (c == '#') {
        while (at_ < bytes_.size() && bytes_[at_] != '\n') ++at_;
      } else if (c == ' ' || (c >= '\t' && c <= '\r')) {
        ++at_;
      } else {
        return;
      }
    }
  }

  const std::filesystem::path& path_;
  Bytes bytes_;
  std::size_t at_;
};

void read_binary(const std::filesystem::path& path, Bytes bytes, RawImage& image) {
  const auto needed = static_cast<std::size_t>(image.num_bytes());
  if (bytes.size() < needed) fail_truncated(path, needed, bytes.size());
  if (image.type == PixelType::kUint8) {
    std::copy_n(bytes.begin(), needed, image.values<std::uint8_t>());
    return;
  }
  for (std::size_t p = 0; p < needed / 2; ++p) {
    image.values<std::uint16_t>()[p] =
        static_cast<std::uint16_t>(bytes[2 * p] << 8 | bytes[2 * p + 1]);
  }
}

}  // namespace

RawImage read_pgm(const std::filesystem::path& path, bool with_pixels) {
  const auto bytes = read_bytes(path);
  const auto kind = ByteReader(bytes, true).text(0, 2);
  if (kind != "P5" && kind != "P2") {
    fail(path, "this is not a PGM file (it begins with neither P5 nor P2)");
  }
  NumberReader numbers(path, bytes, 2);
  RawImage image;
  const int width = numbers.next(1'000'000, "width"), height = numbers.next(1'000'000, "height");
  const int largest = numbers.next(65535, "largest value");
  if (width < 1 || height < 1 || largest < 1) fail(path, "the header of the PGM file is not valid");
  image.size = {width, height};
  image.set_plain_geometry(2);
  image.type = largest < 256 ? PixelType::kUint8 : PixelType::kUint16;
  if (!with_pixels) return image;
  if (kind == "P5") {
    const std::size_t start = std::min(numbers.position() + 1, bytes.size());  // one white space
    if (bytes.size() - start < static_cast<std::size_t>(image.num_bytes())) {
      fail_truncated(path, start + static_cast<std::size_t>(image.num_bytes()), bytes.size());
    }
    image.allocate();
    read_binary(path, Bytes(bytes).subspan(start), image);
    return image;
  }
  if (static_cast<std::uint64_t>(image.num_pixels()) > bytes.size()) {
    fail_truncated(path, static_cast<std::uint64_t>(image.num_pixels()), bytes.size());
  }
  image.allocate();
  for (std::int64_t p = 0; p < image.num_pixels(); ++p) {
    const int value = numbers.next(largest, "pixel value");
    if (image.type == PixelType::kUint8) {
      image.values<std::uint8_t>()[p] = static_cast<std::uint8_t>(value);
    } else {
      image.values<std::uint16_t>()[p] = static_cast<std::uint16_t>(value);
    }
  }
  return image;
}

void write_pgm(const std::filesystem::path& path, const RawImage& image) {
  const bool wide = image.type == PixelType::kUint16;
  std::ofstream stream(path, std::ios::binary);
  stream << "P5\n" << image.size[0] << ' ' << image.size[1] << '\n' << (wide ? 65535 : 255) << '\n';
  if (!wide) {
    stream.write(image.values<char>(), image.num_bytes());
  } else {
    std::string bytes;
    bytes.reserve(static_cast<std::size_t>(image.num_bytes()));
    for (std::int64_t p = 0; p < image.num_pixels(); ++p) {
      const std::uint16_t v = image.values<std::uint16_t>()[p];
      bytes.push_back(static_cast<char>(v >> 8));
      bytes.push_back(static_cast<char>(v & 0xff));
    }
    stream.write(bytes.data(), std::ssize(bytes));
  }
  stream.close();
  if (!stream) fail(path, "writing the image failed; is the disk full?");
}

}  // namespace crease
