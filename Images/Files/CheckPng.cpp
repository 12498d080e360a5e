#include <zlib.h>

#include "Core/Error.h"
#include "Images/Files/FileBytes.h"
#include "Images/Files/FileChecks.h"

namespace crease {
namespace {

constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);
constexpr std::uint64_t kLargestSide = 1'000'000;  // libpng's own limit

struct Chunk {
  std::string_view type;
  std::uint64_t data = 0;    // offset
  std::uint64_t length = 0;  // bytes of data
};

Chunk read_chunk(const std::filesystem::path& path, const ByteReader& reader, std::uint64_t at) {
  if (!reader.holds(at, 12)) fail_truncated(path, at + 12, reader.size());
  const Chunk chunk{reader.text(at + 4, 4), at + 8, reader.number(at, 4)};
  if (!reader.holds(chunk.data, chunk.length + 4)) {
    fail_truncated(path, chunk.data + chunk.length + 4, reader.size());
  }
  const auto covered = reader.bytes().subspan(at + 4, chunk.length + 4);
  const auto crc = crc32(0, covered.data(), static_cast<uInt>(covered.size()));
  if (crc != reader.number(chunk.data + chunk.length, 4)) {
    fail(path, message("the PNG file is damaged (check sum of its ", chunk.type, " chunk)"));
  }
  return chunk;
}

/// Returns whether the image has a palette.
bool check_header(const std::filesystem::path& path, const ByteReader& reader,
                  const Chunk& header) {
  const auto width = reader.number(header.data, 4), height = reader.number(header.data + 4, 4);
  const auto depth = reader.number(header.data + 8, 1), colour = reader.number(header.data + 9, 1);
  const bool whole_bytes = depth == 8 || depth == 16;
  const bool good_depth = colour == 0 ? depth == 1 || depth == 2 || depth == 4 || whole_bytes
                          : colour == 3
                              ? depth == 1 || depth == 2 || depth == 4 || depth == 8
                              : (colour == 2 || colour == 4 || colour == 6) && whole_bytes;
  if (header.length != 13 || width == 0 || height == 0 || !good_depth ||
      reader.number(header.data + 10, 2) != 0 || reader.number(header.data + 12, 1) > 1) {
    fail(path, "the header of the PNG file is not valid");
  }
  if (width > kLargestSide || height > kLargestSide) {
    fail(path, message("an image of ", width, " x ", height, " pixels is too large for PNG"));
  }
  return colour == 3;
}

}  // namespace

void check_png(const std::filesystem::path& path) {
  const auto bytes = read_bytes(path);
  const ByteReader reader(bytes, true);
  if (reader.text(0, kSignature.size()) != kSignature) fail(path, "this is not a PNG file");
  const Chunk header = read_chunk(path, reader, kSignature.size());
  if (header.type != "IHDR") fail(path, "the header of the PNG file is not valid");
  const bool needs_palette = check_header(path, reader, header);
  bool palette = false, pixels = false;
  for (std::uint64_t at = header.data + header.length + 4;;) {
    const Chunk chunk = read_chunk(path, reader, at);
    at = chunk.data + chunk.length + 4;
    if (chunk.type == "IEND") break;
    const bool critical = (chunk.type[0] & 0x20) == 0;
    if (chunk.type == "PLTE") {
      if (pixels || palette || chunk.length == 0 || chunk.length > 768 || chunk.length % 3 != 0) {
        fail(path, "the palette of the PNG file is not valid");
      }
      palette = true;
    } else if (chunk.type == "IDAT") {
      pixels = true;
    } else if (critical) {
      fail(path, message("the PNG file has an unknown part ", chunk.type));
    }
  }
  if (!pixels || (needs_palette && !palette)) {
    fail(path, needs_palette && !palette ? "the palette of the PNG file is missing"
                                         : "the PNG file holds no pixels");
  }
}

}  // namespace crease
