#include <algorithm>
#include <cstdlib>
#include <map>

#include "Core/Error.h"
#include "Images/Files/FileBytes.h"
#include "Images/Files/FileChecks.h"
#include "Images/Files/TextHeader.h"

namespace crease {
namespace {

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

/// Reads "field: value" lines up to an empty line or, in a header of its own, the end.
HeaderFields read_fields(const std::filesystem::path& path, std::string_view text,
                         std::size_t& at) {
  if (!text.starts_with("NRRD000")) fail(path, "this is not an NRRD file");
  next_line(text, at);
  HeaderFields fields;
  while (at < text.size()) {
    const auto line = next_line(text, at);
    if (line && line->empty()) return fields;
    const std::string_view content = line ? *line : text.substr(at);
    if (!line) at = text.size();
    const auto colon = content.find(':');
    if (content.starts_with('#') || colon == std::string_view::npos) continue;
    if (content.substr(colon).starts_with(":=")) continue;  // a note, not a field
    fields[lower_case(trimmed(content.substr(0, colon)))] = trimmed(content.substr(colon + 1));
  }
  if (!fields.contains("data file") && !fields.contains("datafile")) {
    fail(path, "the header of the NRRD file is truncated");
  }
  return fields;
}

std::uint64_t bytes_of_type(const std::filesystem::path& path, const std::string& type) {
  static const std::map<std::string, std::uint64_t> bytes{{"signed char", 1},
                                                          {"int8", 1},
                                                          {"int8_t", 1},
                                                          {"uchar", 1},
                                                          {"unsigned char", 1},
                                                          {"uint8", 1},
                                                          {"uint8_t", 1},
                                                          {"short", 2},
                                                          {"short int", 2},
                                                          {"signed short", 2},
                                                          {"int16", 2},
                                                          {"int16_t", 2},
                                                          {"ushort", 2},
                                                          {"unsigned short", 2},
                                                          {"unsigned short int", 2},
                                                          {"uint16", 2},
                                                          {"uint16_t", 2},
                                                          {"int", 4},
                                                          {"signed int", 4},
                                                          {"int32", 4},
                                                          {"int32_t", 4},
                                                          {"uint", 4},
                                                          {"unsigned int", 4},
                                                          {"uint32", 4},
                                                          {"uint32_t", 4},
                                                          {"longlong", 8},
                                                          {"long long", 8},
                                                          {"int64", 8},
                                                          {"int64_t", 8},
                                                          {"ulonglong", 8},
                                                          {"unsigned long long", 8},
                                                          {"uint64", 8},
                                                          {"uint64_t", 8},
                                                          {"float", 4},
                                                          {"double", 8}};
  const auto found = bytes.find(type);
  if (found == bytes.end())
    fail(path, message("NRRD pixels of type '", type, "' are not supported"));
  return found->second;
}

void check_data(const std::filesystem::path& path, const std::string& encoding, Bytes content,
                std::uint64_t values, std::uint64_t needed) {
  if (encoding == "raw") {
    if (content.size() < needed) fail_truncated(path, needed, content.size());
  } else if (encoding == "gzip" || encoding == "gz") {
    if (inflated_size(content) < needed) {
      fail(path, "the compressed pixels are truncated or damaged; copy or export the file again");
    }
  } else if (encoding == "txt" || encoding == "text" || encoding == "ascii") {
    const auto found = count_words(ByteReader(content, false).text(0, content.size()), values);
    if (found < values) {
      fail(path, message("the file is truncated: it needs ", values, " numbers and has ", found));
    }
  } else {
    fail(path,
         message("the encoding '", encoding, "' is not supported; write the file as raw or gzip"));
  }
}

}  // namespace

FileFacts check_nrrd(const std::filesystem::path& path) {
  const auto bytes = read_bytes(path);
  std::size_t at = 0;
  const HeaderFields fields = read_fields(path, ByteReader(bytes, false).text(0, bytes.size()), at);
  const std::string sizes = value_of(fields, "sizes", "");
  const auto values = product_of_sizes(sizes);
  if (sizes.empty() || values == 0 ||
      count_words(sizes, 100) !=
          std::strtoull(value_of(fields, "dimension", "0").c_str(), nullptr, 10)) {
    fail(path, "the sizes in the header of the NRRD file are not valid");
  }
  const auto needed = values * bytes_of_type(path, lower_case(value_of(fields, "type", "missing")));
  const std::string encoding = lower_case(value_of(fields, "encoding", "missing"));

  const bool tells_spacing = fields.contains("spacings") || fields.contains("space directions");

  std::string name = value_of(fields, "data file", "");
  if (name.empty()) name = value_of(fields, "datafile", "");
  if (name.starts_with("LIST") || name.find('%') != std::string::npos) {
    fail(path,
         "pixels spread over several files are not supported; write them into one .nrrd file");
  }
  if (value_of(fields, "byte skip", "0") != "0" || value_of(fields, "line skip", "0") != "0") {
    if (name.empty()) fail(path, "skipping within an NRRD file is not supported");
  }
  if (name.empty()) {
    check_data(path, encoding, Bytes(bytes).subspan(at), values, needed);
    return {tells_spacing};
  }
  const auto data_path = path.parent_path() / name;
  if (!std::filesystem::exists(data_path)) {
    fail(path, message("its pixels, the file ", data_path.string(), ", are missing"));
  }
  const auto data = read_bytes(data_path);
  const auto skip = std::strtoull(value_of(fields, "byte skip", "0").c_str(), nullptr, 10);
  const auto skipped = static_cast<std::size_t>(std::min<std::uint64_t>(skip, data.size()));
  check_data(data_path, encoding, Bytes(data).subspan(skipped), values, needed);
  return {tells_spacing};
}

}  // namespace crease
