#include "Images/Files/FileBytes.h"

#include <zlib.h>

#include <fstream>
#include <memory>

#include "Core/Error.h"

namespace crease {

void fail(const std::filesystem::path& path, const std::string& what) {
  throw FileError(message(path.string(), ": ", what));
}

void fail_truncated(const std::filesystem::path& path, std::uintmax_t needed,
                    std::uintmax_t found) {
  fail(path, message("the file is truncated: it needs ", needed, " bytes and has ", found,
                     "; copy or export it again"));
}

std::vector<std::uint8_t> read_bytes(const std::filesystem::path& path, std::uintmax_t limit) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) fail(path, "there is no such file");
  if (std::filesystem::is_directory(status)) {
    fail(path, "this is a folder, not an image file; name one file");
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) fail(path, "the file cannot be opened; check its permissions");
  const auto size = std::filesystem::file_size(path, error);
  if (error) fail(path, "this is not a regular file");
  if (size == 0) fail(path, "the file is empty");
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(std::min(size, limit)));
  stream.read(reinterpret_cast<char*>(bytes.data()), std::ssize(bytes));
  if (stream.gcount() != std::ssize(bytes)) fail(path, "the file cannot be read to its end");
  return bytes;
}

std::vector<std::uint8_t> decompress(const std::filesystem::path& path) {
  std::vector<std::uint8_t> bytes = read_bytes(path);
  if (ByteReader(bytes, true).number(0, 2) != 0x1f8b) return bytes;
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
  if (file == nullptr) fail(path, "the file cannot be opened; check its permissions");
  std::size_t size = 0;
  bytes.resize(8 * bytes.size() + 65536);
  for (;;) {
    const auto room = static_cast<unsigned>(std::min<std::size_t>(bytes.size() - size, 1u << 30));
    const int count = gzread(file.get(), bytes.data() + size, room);
    int code = Z_OK;
    gzerror(file.get(), &code);
    if (count < 0 || code == Z_BUF_ERROR || code == Z_DATA_ERROR) {
      fail(path, "the compressed data are truncated or damaged; copy or export the file again");
    }
    size += static_cast<std::size_t>(count);
    if (count == 0) break;
    if (size == bytes.size()) bytes.resize(2 * bytes.size());
  }
  bytes.resize(size);
  return bytes;
}

std::uintmax_t inflated_size(Bytes data) {
  z_stream stream{};
  if (inflateInit2(&stream, 15 + 32) != Z_OK) return 0;
  std::vector<std::uint8_t> buffer(1 << 17);
  std::uintmax_t total = 0;
  int code = Z_OK;
  while (code == Z_OK) {
    if (stream.avail_in == 0) {
      const auto chunk = std::min<std::size_t>(data.size(), 1u << 30);
      stream.next_in = const_cast<Bytef*>(data.data());
      stream.avail_in = static_cast<uInt>(chunk);
      data = data.subspan(chunk);
    }
    stream.next_out = buffer.data();
    stream.avail_out = static_cast<uInt>(buffer.size());
    code = inflate(&stream, Z_NO_FLUSH);
    total += buffer.size() - stream.avail_out;
  }
  inflateEnd(&stream);
  return code == Z_STREAM_END ? total : 0;
}

std::uint64_t ByteReader::number(std::uint64_t offset, int count) const {
  if (!holds(offset, static_cast<std::uint64_t>(count))) return 0;
  std::uint64_t value = 0;
  for (int k = 0; k < count; ++k) {
    const int at = big_endian_ ? k : count - 1 - k;
    value = value << 8 | bytes_[static_cast<std::size_t>(offset) + static_cast<std::size_t>(at)];
  }
  return value;
}

std::string_view ByteReader::text(std::uint64_t offset, std::size_t count) const {
  if (!holds(offset, count)) return {};
  return {reinterpret_cast<const char*>(bytes_.data()) + offset, count};
}

}  // namespace crease
