#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace crease {

using Bytes = std::span<const std::uint8_t>;

/// The file's bytes, at most `limit` of them.
/// @throws FileError when there is no such file, it is a folder, cannot be read or is empty.
std::vector<std::uint8_t> read_bytes(const std::filesystem::path& path,
                                     std::uintmax_t limit = UINTMAX_MAX);

/// What a file compressed by gzip holds, or the file itself if it is not compressed.
/// @throws FileError as read_bytes, and when the compressed data are truncated or damaged.
std::vector<std::uint8_t> decompress(const std::filesystem::path& path);

/// Bytes that zlib's or gzip's format unpacks to; 0 when the data are truncated or damaged.
std::uintmax_t inflated_size(Bytes data);

/// Numbers from bytes in a given order.
class ByteReader {
 public:
  ByteReader(Bytes bytes, bool big_endian) : bytes_(bytes), big_endian_(big_endian) {}
  std::size_t size() const { return bytes_.size(); }
  bool holds(std::uint64_t offset, std::uint64_t count) const {
    return offset <= bytes_.size() && count <= bytes_.size() - offset;
  }
  /// The number of `count` <= 8 bytes at the offset; 0 when it lies beyond the end.
  std::uint64_t number(std::uint64_t offset, int count) const;
  std::string_view text(std::uint64_t offset, std::size_t count) const;
  Bytes bytes() const { return bytes_; }

 private:
  Bytes bytes_;
  bool big_endian_;
};

/// @throws FileError "NAME: what".
[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what);
/// "the file is truncated: needed bytes, found bytes".
[[noreturn]] void fail_truncated(const std::filesystem::path& path, std::uintmax_t needed,
                                 std::uintmax_t found);

}  // namespace crease
