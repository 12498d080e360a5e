#include "Images/PngEncoder.h"

#include <zlib.h>

#include <new>
#include <vector>

#include "Core/Error.h"

namespace crease {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::string big_endian(std::uint32_t value) {
  std::string text(4, '\0');
  for (std::size_t b = 0; b < 4; ++b) text[b] = static_cast<char>(value >> (24 - 8 * b) & 255);
  return text;
}

/// Length, kind, data and checksum: what a PNG file consists of.
void add_chunk(std::string& file, const std::string& kind, const std::string& data) {
  const std::string checked = kind + data;
  const auto sum =
      crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size()));
  file += big_endian(static_cast<std::uint32_t>(data.size())) + checked +
          big_endian(static_cast<std::uint32_t>(sum));
}

bool is_grey(std::span<const std::uint8_t> rgb) {
  for (std::size_t i = 0; i + 2 < rgb.size(); i += 3) {
    if (rgb[i] != rgb[i + 1] || rgb[i] != rgb[i + 2]) return false;
  }
  return true;
}

/// Every row behind its filter's number, 3: bytes less the average of the ones to the left and above.
Bytes filtered(std::size_t row_bytes, std::size_t height, std::size_t channels,
               std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t kAverage = 3;
  Bytes result(height * (row_bytes + 1));
  const Bytes nothing(row_bytes, 0);
  const std::uint8_t* above = nothing.data();
  std::uint8_t* to = result.data();
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t* row = bytes.data() + y * row_bytes;
    *to++ = kAverage;
    for (std::size_t i = 0; i < row_bytes; ++i) {
      const int left = i < channels ? 0 : row[i - channels];
      *to++ = static_cast<std::uint8_t>(row[i] - (left + above[i]) / 2);
    }
    above = row;
  }
  return result;
}

/// By runs for grey; what repeats in colours is found by a short search.
std::string deflated(Bytes bytes, bool grey) {
  constexpr int kLevel = 1, kWindowBits = 15, kMemory = 9;
  z_stream stream{};
  if (deflateInit2(&stream, kLevel, Z_DEFLATED, kWindowBits, kMemory,
                   grey ? Z_RLE : Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::bad_alloc();
  }
  std::string result(deflateBound(&stream, static_cast<uLong>(bytes.size())), '\0');
  stream.next_in = bytes.data();
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  deflate(&stream, Z_FINISH);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  return result;
}

}  // namespace

std::string encode_png(int width, int height, int channels, std::span<const std::uint8_t> bytes) {
  const bool known = channels == 1 || channels == 3;
  if (!known || width < 1 || height < 1 ||
      std::ssize(bytes) != std::int64_t{channels} * width * height) {
    throw InvalidInput(message("a picture of ", width, " x ", height, " pixels has 1 or 3 bytes ",
                               "per pixel; there are ", channels, " channels and ", bytes.size(),
                               " bytes"));
  }
  Bytes grey;
  if (channels == 3 && is_grey(bytes)) {
    for (std::size_t i = 0; i < bytes.size(); i += 3) grey.push_back(bytes[i]);
    bytes = grey;
    channels = 1;
  }
  constexpr char kDepth = 8, kGrey = 0, kColour = 2;
  std::string header = big_endian(static_cast<std::uint32_t>(width)) +
                       big_endian(static_cast<std::uint32_t>(height));
  header += {kDepth, channels == 1 ? kGrey : kColour, 0, 0, 0};
  std::string file = "\x89PNG\r\n\x1a\n";
  add_chunk(file, "IHDR", header);
  const auto sides = [](int a, int b) { return static_cast<std::size_t>(a) * b; };
  add_chunk(file, "IDAT",
            deflated(filtered(sides(channels, width), sides(height, 1), sides(channels, 1), bytes),
                     channels == 1));
  add_chunk(file, "IEND", "");
  return file;
}

}  // namespace crease
