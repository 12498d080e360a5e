#include <array>

#include "Core/Error.h"
#include "Images/Files/FileBytes.h"
#include "Images/Files/FileChecks.h"

namespace crease {
namespace {

enum Tag : std::uint64_t {
  kWidth = 256,
  kHeight = 257,
  kStripOffsets = 273,
  kStripByteCounts = 279,
  kTileOffsets = 324,
  kTileByteCounts = 325
};

/// The directories of a TIFF or BigTIFF file.
class TiffWalker {
 public:
  TiffWalker(const std::filesystem::path& path, const ByteReader& reader, bool big)
      : path_(path), reader_(reader), big_(big) {}

  void check() {
    std::uint64_t at = big_ ? reader_.number(8, 8) : reader_.number(4, 4);
    int count = 0;
    while (at != 0) {
      at = check_directory(at);
      if (++count > 65535) fail(path_, "the TIFF file is damaged: its directories form a circle");
    }
    if (count == 0) fail(path_, "the TIFF file holds no image");
  }

 private:
  struct Entry {
    std::uint64_t tag = 0, count = 0, values = 0;  // values: where they stand
    int bytes = 1;                                 // per value
  };

  Entry read_entry(std::uint64_t at) const {
    constexpr std::array<int, 19> kBytes{1, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 1, 1, 8, 8, 8};
    const auto type = reader_.number(at + 2, 2);
    Entry entry{reader_.number(at, 2), reader_.number(at + 4, offset_bytes()), 0, 1};
    if (type < kBytes.size()) entry.bytes = kBytes[type];
    const std::uint64_t inside = at + 4 + static_cast<std::uint64_t>(offset_bytes());
    if (entry.count > reader_.size()) fail(path_, "the file is truncated or damaged");
    const std::uint64_t total = entry.count * static_cast<std::uint64_t>(entry.bytes);
    const bool fits = total <= static_cast<std::uint64_t>(offset_bytes());
    entry.values = fits ? inside : reader_.number(inside, offset_bytes());
    if (!reader_.holds(entry.values, total)) {
      fail_truncated(path_, entry.values + total, reader_.size());
    }
    return entry;
  }

  std::uint64_t value(const Entry& entry, std::uint64_t k) const {
    return reader_.number(entry.values + k * static_cast<std::uint64_t>(entry.bytes), entry.bytes);
  }

  /// Returns the offset of the next directory.
  std::uint64_t check_directory(std::uint64_t at) const {
    const int count_bytes = big_ ? 8 : 2;
    if (!reader_.holds(at, static_cast<std::uint64_t>(count_bytes))) {
      fail_truncated(path_, at + static_cast<std::uint64_t>(count_bytes), reader_.size());
    }
    const std::uint64_t entries = reader_.number(at, count_bytes), entry_bytes = big_ ? 20 : 12;
    at += static_cast<std::uint64_t>(count_bytes);
    const std::uint64_t end = at + entries * entry_bytes;
    if (entries > reader_.size() ||
        !reader_.holds(end, static_cast<std::uint64_t>(offset_bytes()))) {
      fail_truncated(path_, end + static_cast<std::uint64_t>(offset_bytes()), reader_.size());
    }
    Entry offsets, counts;
    bool width = false, height = false;
    for (std::uint64_t k = 0; k < entries; ++k) {
      const Entry entry = read_entry(at + k * entry_bytes);
      if (entry.tag == kWidth) width = value(entry, 0) > 0;
      if (entry.tag == kHeight) height = value(entry, 0) > 0;
      if (entry.tag == kStripOffsets || entry.tag == kTileOffsets) offsets = entry;
      if (entry.tag == kStripByteCounts || entry.tag == kTileByteCounts) counts = entry;
    }
    if (!width || !height || offsets.count == 0) fail(path_, "the TIFF file holds no image");
    for (std::uint64_t k = 0; k < std::min(offsets.count, counts.count); ++k) {
      if (!reader_.holds(value(offsets, k), value(counts, k))) {
        fail_truncated(path_, value(offsets, k) + value(counts, k), reader_.size());
      }
    }
    return reader_.number(end, offset_bytes());
  }

  int offset_bytes() const { return big_ ? 8 : 4; }

  const std::filesystem::path& path_;
  const ByteReader& reader_;
  bool big_;
};

}  // namespace

void check_tiff(const std::filesystem::path& path) {
  const auto bytes = read_bytes(path);
  const std::string_view order = ByteReader(bytes, false).text(0, 2);
  const ByteReader reader(bytes, order == "MM");
  const auto version = reader.number(2, 2);
  if ((order != "II" && order != "MM") || (version != 42 && version != 43)) {
    fail(path, "this is not a TIFF file");
  }
  TiffWalker(path, reader, version == 43).check();
}

}  // namespace crease
