#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <type_traits>

#include "Core/Error.h"
#include "Images/Files/FileBytes.h"
#include "Images/Files/FileChecks.h"

namespace crease {
namespace {

constexpr std::size_t kHeaderBytes = 348;

/// "hdr" or "img" for one half of a pair, compressed or not; "nii" otherwise.
std::string kind_of(const std::filesystem::path& path) {
  auto extension = path.extension();
  if (extension == ".gz" || extension == ".GZ") extension = path.stem().extension();
  std::string kind = extension.string().substr(std::min<std::size_t>(1, extension.string().size()));
  for (char& c : kind) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return kind;
}

/// The other half of a pair.
std::filesystem::path partner(const std::filesystem::path& path, const std::string& kind) {
  auto stem = path;
  if (stem.extension() == ".gz" || stem.extension() == ".GZ") stem.replace_extension();
  for (const char* ending : {"", ".gz"}) {
    auto other = stem;
    other.replace_extension(kind == "hdr" ? "img" : "hdr");
    other += ending;
    if (std::filesystem::exists(other)) return other;
  }
  stem.replace_extension(kind == "hdr" ? "img" : "hdr");
  fail(path, message("its other half, ", stem.filename().string(),
                     ", is missing; keep both files in one folder"));
}

/// Values that the image has, all axes counted.
std::uint64_t num_values(const std::filesystem::path& path, const ByteReader& reader) {
  const auto axes = reader.number(40, 2);
  if (axes < 1 || axes > 7) fail(path, message("a NIfTI image of ", axes, " axes is not valid"));
  std::uint64_t values = 1;
  for (std::uint64_t a = 1; a <= axes; ++a) {
    const auto size = static_cast<std::int16_t>(reader.number(40 + 2 * a, 2));
    if (size < 1) fail(path, message("axis ", a, " of the NIfTI image has ", size, " pixels"));
    values *= static_cast<std::uint64_t>(size);
    if (values > 1'000'000'000'000'000) fail(path, "the sizes of the NIfTI image are not valid");
  }
  return values;
}

template <typename Float>
void find_not_finite(const ByteReader& reader, std::uint64_t start, std::uint64_t count,
                     NiftiFacts& facts) {
  using Bits = std::conditional_t<sizeof(Float) == 4, std::uint32_t, std::uint64_t>;
  for (std::uint64_t k = 0; k < count; ++k) {
    const auto bits = static_cast<Bits>(reader.number(start + k * sizeof(Float), sizeof(Float)));
    const auto value = std::bit_cast<Float>(bits);
    if (std::isfinite(value)) continue;
    facts.not_finite.push_back({static_cast<std::int64_t>(k), static_cast<double>(value)});
  }
}

}  // namespace

NiftiFacts check_nifti(const std::filesystem::path& path) {
  read_bytes(path, 1);  // says what is wrong with the file itself
  const std::string kind = kind_of(path);
  const bool pair = kind == "hdr" || kind == "img";
  const auto header_path = kind == "img" ? partner(path, kind) : path;
  const auto data_path = kind == "hdr" ? partner(path, kind) : path;
  const auto header = decompress(header_path);
  const bool big_endian = ByteReader(header, true).number(0, 4) == kHeaderBytes;
  const ByteReader reader(header, big_endian);
  if (ByteReader(header, true).number(0, 4) == 540 ||
      ByteReader(header, false).number(0, 4) == 540) {
    fail(
        header_path,
        "this is a NIfTI-2 file; only NIfTI-1 can be read: convert it, for example with nifti_tool "
        "or nibabel, or to MetaImage");
  }
  if (reader.number(0, 4) != kHeaderBytes) fail(header_path, "this is not a NIfTI-1 file");
  if (reader.size() < kHeaderBytes) fail_truncated(header_path, kHeaderBytes, reader.size());
  if (!pair && reader.text(344, 3) != "n+1") fail(header_path, "this is not a NIfTI-1 file");
  const auto offset = std::bit_cast<float>(static_cast<std::uint32_t>(reader.number(108, 4)));
  if (!(offset >= 0) || offset > 1e9f)
    fail(header_path, "the header of the NIfTI file is not valid");
  const auto start = std::max<std::uint64_t>(static_cast<std::uint64_t>(offset), pair ? 0 : 352);
  const auto type = reader.number(70, 2), bits = reader.number(72, 2);
  if (bits == 0 || bits % 8 != 0 || bits > 256) {
    fail(header_path, message("NIfTI pixels of ", bits, " bits are not supported"));
  }

  const auto separate = pair ? decompress(data_path) : std::vector<std::uint8_t>();
  const ByteReader data(pair ? Bytes(separate) : Bytes(header), big_endian);
  const auto count = num_values(header_path, reader);
  const auto needed = start + count * bits / 8;
  if (data.size() < needed) fail_truncated(data_path, needed, data.size());
  NiftiFacts facts;
  if (type == 16 && bits == 32) find_not_finite<float>(data, start, count, facts);
  if (type == 64 && bits == 64) find_not_finite<double>(data, start, count, facts);
  return facts;
}

}  // namespace crease
