#include <algorithm>
#include <cstdlib>
#include <map>

#include "Core/Error.h"
#include "Images/Files/FileBytes.h"
#include "Images/Files/FileChecks.h"
#include "Images/Files/TextHeader.h"

namespace crease {
namespace {

constexpr std::uintmax_t kLongestHeader = 1 << 20;  // bytes

/// Reads "Key = value" lines up to ElementDataFile, the last one.
HeaderFields read_fields(const std::filesystem::path& path, std::string_view text,
                         std::size_t& at) {
  HeaderFields fields;
  while (!fields.contains("ElementDataFile")) {
    std::optional<std::string_view> line = next_line(text, at);
    if (!line && at < text.size()) {  // a header of its own need not end its last line
      line = text.substr(at);
      at = text.size();
    }
    const auto equals = line ? line->find('=') : std::string_view::npos;
    if (equals == std::string_view::npos) {
      if (line && trimmed(*line).empty()) continue;
      fail(path, fields.empty() ? "this is not a MetaImage file"
                                : "the header of the MetaImage file is truncated or damaged");
    }
    fields[std::string(trimmed(line->substr(0, equals)))] = trimmed(line->substr(equals + 1));
  }
  return fields;
}

bool is_true(const std::string& value) {
  return !value.empty() && (value[0] == 'T' || value[0] == 't' || value[0] == '1');
}

std::uint64_t bytes_of_type(const std::filesystem::path& path, std::string type) {
  if (type.ends_with("_ARRAY")) type.resize(type.size() - 6);
  static const std::map<std::string, std::uint64_t> bytes{
      {"MET_CHAR", 1},      {"MET_UCHAR", 1},      {"MET_SHORT", 2}, {"MET_USHORT", 2},
      {"MET_INT", 4},       {"MET_UINT", 4},       {"MET_LONG", 4},  {"MET_ULONG", 4},
      {"MET_LONG_LONG", 8}, {"MET_ULONG_LONG", 8}, {"MET_FLOAT", 4}, {"MET_DOUBLE", 8}};
  const auto found = bytes.find(type);
  if (found == bytes.end())
    fail(path, message("MetaImage pixels of type '", type, "' are not supported"));
  return found->second;
}

/// Those of a file behind the first `before` ones.
std::uintmax_t bytes_behind(const std::filesystem::path& path, std::uintmax_t before) {
  read_bytes(path, 1);  // fails as it does for all files that cannot be read
  const auto size = std::filesystem::file_size(path);
  return size - std::min<std::uintmax_t>(size, before);
}

/// What a header promises.
struct Pixels {
  std::uint64_t values, channels, bytes;
};

/// Whether the file of the pixels, which begin `at`, holds them all.
void check_pixels(const std::filesystem::path& path, const HeaderFields& fields, std::size_t at,
                  const std::filesystem::path& data_path, const Pixels& pixels) {
  const bool compressed = is_true(value_of(fields, "CompressedData", "False"));
  if (!compressed && is_true(value_of(fields, "BinaryData", "True"))) {
    const long skipped = std::atol(value_of(fields, "HeaderSize", "0").c_str());
    const auto before = data_path == path ? at : static_cast<std::uint64_t>(std::max(0l, skipped));
    const auto found = bytes_behind(data_path, before);
    if (found < pixels.bytes) fail_truncated(data_path, pixels.bytes, found);
    return;
  }
  const auto data = read_bytes(data_path);
  const Bytes content = Bytes(data).subspan(at);
  if (compressed) {
    if (inflated_size(content) < pixels.bytes) {
      fail(data_path,
           "the compressed pixels are truncated or damaged; copy or export the file again");
    }
  } else if (pixels.channels >
             1) {  // ITK reads only the first of them and leaves the rest as it finds it
    fail(path, message("pixels of ", pixels.channels,
                       " values each, written as text, are not supported; "
                       "write them as binary data (BinaryData = True)"));
  } else {
    const auto found =
        count_words(ByteReader(content, false).text(0, content.size()), pixels.values);
    if (found < pixels.values) {
      fail(data_path,
           message("the file is truncated: it needs ", pixels.values, " numbers and has ", found));
    }
  }
}

}  // namespace

FileFacts check_meta_image(const std::filesystem::path& path) {
  const auto bytes = read_bytes(path, kLongestHeader);
  const std::string_view text = ByteReader(bytes, false).text(0, bytes.size());
  std::size_t at = 0;
  const HeaderFields fields = read_fields(path, text, at);
  const auto pixels = product_of_sizes(value_of(fields, "DimSize", ""));
  const auto channels = product_of_sizes(value_of(fields, "ElementNumberOfChannels", "1"));
  if (!fields.contains("DimSize") || pixels == 0 || channels == 0 ||
      count_words(value_of(fields, "DimSize", ""), 100) !=
          std::strtoull(value_of(fields, "NDims", "0").c_str(), nullptr, 10)) {
    fail(path, "the sizes in the header of the MetaImage file are not valid");
  }
  const auto values = pixels * channels;
  const auto needed = values * bytes_of_type(path, value_of(fields, "ElementType", "missing"));

  const std::string name = value_of(fields, "ElementDataFile", "");
  if (name.starts_with("LIST") || name.find('%') != std::string::npos) {
    fail(path, "pixels spread over several files are not supported; write them into one .mha file");
  }
  const bool local = name == "LOCAL" || name == "Local" || name == "local";
  const auto data_path = local ? path : path.parent_path() / name;
  if (!local && !std::filesystem::exists(data_path)) {
    fail(path, message("its pixels, the file ", data_path.string(), ", are missing"));
  }
  check_pixels(path, fields, local ? at : 0, data_path, {values, channels, needed});
  return {fields.contains("ElementSpacing") || fields.contains("ElementSize")};
}

}  // namespace crease
