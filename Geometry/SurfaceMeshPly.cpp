#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>

#include "Geometry/MeshLineReader.h"
#include "Geometry/SurfaceMeshFileForms.h"

namespace crease {
namespace {

/// How a binary file stores a number: its bytes, and what they mean.
struct PlyType {
  int width = 0;
  enum { kUnsigned, kSigned, kFloat } kind = kUnsigned;
};

struct PlyProperty {
  std::string name;
  PlyType type;
  bool is_list = false;
  PlyType count_type;  // of lists
};

/// What the header of a .ply file says.
struct PlyHeader {
  struct Element {
    std::string name;
    int count = 0;
    std::vector<PlyProperty> properties;
  };
  bool binary = false;
  bool big_endian = false;
  std::vector<Element> elements;
};

PlyType type_of(const LineReader& reader, const std::string& name) {
  static const std::map<std::string, PlyType> types = {
      {"char", {1, PlyType::kSigned}},     {"int8", {1, PlyType::kSigned}},
      {"uchar", {1, PlyType::kUnsigned}},  {"uint8", {1, PlyType::kUnsigned}},
      {"short", {2, PlyType::kSigned}},    {"int16", {2, PlyType::kSigned}},
      {"ushort", {2, PlyType::kUnsigned}}, {"uint16", {2, PlyType::kUnsigned}},
      {"int", {4, PlyType::kSigned}},      {"int32", {4, PlyType::kSigned}},
      {"uint", {4, PlyType::kUnsigned}},   {"uint32", {4, PlyType::kUnsigned}},
      {"float", {4, PlyType::kFloat}},     {"float32", {4, PlyType::kFloat}},
      {"double", {8, PlyType::kFloat}},    {"float64", {8, PlyType::kFloat}}};
  const auto at = types.find(name);
  if (at == types.end()) reader.fail(message("the type ", name, " of a property is unknown"));
  return at->second;
}

PlyProperty property_of(const LineReader& reader) {
  PlyProperty property;
  property.is_list = reader.word(1) == "list";
  if (property.is_list) property.count_type = type_of(reader, reader.word(2));
  property.type = type_of(reader, reader.word(property.is_list ? 3 : 1));
  property.name = reader.word(reader.num_words() - 1);
  return property;
}

void read_format(const LineReader& reader, PlyHeader& header) {
  const std::string& format = reader.word(1);
  header.big_endian = format == "binary_big_endian";
  header.binary = header.big_endian || format == "binary_little_endian";
  if (!header.binary && format != "ascii") {
    reader.fail(
        message("the format ", format, " is not known; save the mesh as text (ascii) or as .obj"));
  }
}

PlyHeader read_header(LineReader& reader) {
  reader.require_next("its header");
  if (reader.word(0) != "ply") reader.fail("a .ply file begins with \"ply\"");
  PlyHeader header;
  while (true) {
    reader.require_next("\"end_header\"");
    const std::string& key = reader.word(0);
    if (key == "end_header") return header;
    if (key == "format") read_format(reader, header);
    if (key == "element") header.elements.push_back({reader.word(1), reader.count(2), {}});
    if (key != "property") continue;
    if (header.elements.empty()) reader.fail("a property before the first element");
    header.elements.back().properties.push_back(property_of(reader));
  }
}

/// Where the vertices' coordinates stand among their properties.
std::array<std::size_t, 3> axes_of(const LineReader& reader, const PlyHeader::Element& element) {
  std::array<std::size_t, 3> axes{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string name(1, static_cast<char>('x' + a));
    const auto at = std::ranges::find(element.properties, name, &PlyProperty::name);
    if (at == element.properties.end()) {
      reader.fail(message("the header gives no property ", name, " of ", element.name));
    }
    axes[a] = static_cast<std::size_t>(at - element.properties.begin());
  }
  return axes;
}

SurfaceMesh read_text(LineReader& reader, const PlyHeader& header) {
  SurfaceMesh mesh;
  for (const auto& element : header.elements) {
    std::array<std::size_t, 3> axes{};
    if (element.name == "vertex") axes = axes_of(reader, element);
    for (int i = 0; i < element.count; ++i) {
      reader.require_next("its last element");
      if (element.name == "vertex") mesh.vertices.push_back(reader.point(axes));
      if (element.name != "face") continue;
      mesh.faces.push_back(counted_face(reader, 0));
      check_face(reader, mesh.faces.back(), mesh.vertices.size());
    }
  }
  return mesh;
}

/// Numbers one after the other.
class Bytes {
 public:
  Bytes(const LineReader& reader, std::string bytes, bool big_endian)
      : reader_(reader), bytes_(std::move(bytes)), big_endian_(big_endian) {}

  double next(const PlyType& type) {
    const auto width = static_cast<std::size_t>(type.width);
    if (bytes_.size() - at_ < width) reader_.fail("the file ends before its last element");
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < width; ++k) {
      const std::size_t byte = big_endian_ ? k : width - 1 - k;
      bits = bits << 8 | static_cast<std::uint8_t>(bytes_[at_ + byte]);
    }
    at_ += width;
    if (type.kind == PlyType::kFloat) {
      return width == 8 ? std::bit_cast<double>(bits)
                        : std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    }
    const int unused = 64 - 8 * type.width;
    if (type.kind == PlyType::kUnsigned) return static_cast<double>(bits);
    return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
  }
  /// At most as many as there are bytes left.
  std::size_t count(const PlyType& type) {
    const double value = next(type);
    if (!(value >= 0 && value <= static_cast<double>(bytes_.size())) ||
        value != std::floor(value)) {
      reader_.fail(message("a list of ", value, " entries"));
    }
    return static_cast<std::size_t>(value);
  }

 private:
  const LineReader& reader_;
  std::string bytes_;
  std::size_t at_ = 0;
  bool big_endian_;
};

SurfaceMesh read_binary(LineReader& reader, const PlyHeader& header) {
  Bytes bytes(reader, reader.rest(), header.big_endian);
  SurfaceMesh mesh;
  for (const auto& element : header.elements) {
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
    std::array<std::size_t, 3> axes{};
    if (is_vertex) axes = axes_of(reader, element);
    std::vector<double> values(element.properties.size());
    for (int i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < values.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (!property.is_list) {
          values[p] = bytes.next(property.type);
          continue;
        }
        std::vector<int> list(bytes.count(property.count_type));
        for (int& entry : list) {
          entry = static_cast<int>(std::clamp(bytes.next(property.type), -1.0, 2147483647.0));
        }
        if (!is_face || !property.name.starts_with("vertex_ind")) continue;
        check_face(reader, list, mesh.vertices.size());
        mesh.faces.push_back(std::move(list));
      }
      if (!is_vertex) continue;
      mesh.vertices.emplace_back(values[axes[0]], values[axes[1]], values[axes[2]]);
      if (!mesh.vertices.back().allFinite()) {
        reader.fail(message("vertex ", i, " (from 0) is not finite"));
      }
    }
  }
  return mesh;
}

}  // namespace

SurfaceMesh read_ply(const std::filesystem::path& path) {
  LineReader reader(path, 0);
  const PlyHeader header = read_header(reader);
  return header.binary ? read_binary(reader, header) : read_text(reader, header);
}

}  // namespace crease
