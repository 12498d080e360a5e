#include "Geometry/SurfaceMeshFile.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "Core/Error.h"
#include "Core/WholeFile.h"

namespace crease {
namespace {

namespace fs = std::filesystem;

enum class Format { kObj, kOff, kPly };

std::optional<Format> format_of(const fs::path& path) {
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending == ".obj") return Format::kObj;
  if (ending == ".off") return Format::kOff;
  if (ending == ".ply") return Format::kPly;
  return std::nullopt;
}

Format known_format(const fs::path& path) {
  if (const auto format = format_of(path)) return *format;
  throw InvalidInput(
      message(path.string(), ": the mesh format is not known; known are .obj, .off and .ply"));
}

/// The lines of a text file, word by word.
class LineReader {
 public:
  /// @param comment  what begins a comment; 0: nothing does.
  LineReader(const fs::path& path, char comment) : path_(path), comment_(comment), stream_(path) {
    if (!stream_ || fs::is_directory(path)) {
      throw FileError(message(path.string(), ": the file cannot be read"));
    }
  }
  /// Goes to the next line that is not empty. @return false at the end of the file.
  bool next() {
    for (std::string line; std::getline(stream_, line);) {
      ++number_;
      if (comment_ != 0) line.erase(std::min(line.size(), line.find(comment_)));
      words_.clear();
      for (std::size_t begin = 0; begin < line.size();) {
        const auto from = line.find_first_not_of(" \t\r", begin);
        if (from == std::string::npos) break;
        begin = std::min(line.size(), line.find_first_of(" \t\r", from));
        words_.push_back(line.substr(from, begin - from));
      }
      if (!words_.empty()) return true;
    }
    words_.clear();
    return false;
  }
  void require_next(const char* what) {
    if (!next()) {
      throw InvalidInput(
          message(path_.string(), ": the file ends before ", what, "; it may be cut off"));
    }
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw InvalidInput(message(path_.string(), ", line ", number_, ": ", what));
  }
  std::size_t num_words() const { return words_.size(); }
  const std::string& word(std::size_t i) const {
    if (i >= words_.size()) fail(message("there is no word ", i + 1));
    return words_[i];
  }
  template <typename Number>
  Number number(std::size_t i) const {
    return parse<Number>(word(i));
  }
  template <typename Number>
  Number parse(std::string_view text) const {
    Number value{};
    const char* end = text.data() + text.size();
    const auto [last, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || last != end) fail(message("\"", text, "\" is not a number"));
    return value;
  }
  int count(std::size_t i) const {
    const int value = number<int>(i);
    if (value < 0) fail(message("a count of ", value));
    return value;
  }
  Point<3> point(std::array<std::size_t, 3> columns) const {
    Point<3> p(number<double>(columns[0]), number<double>(columns[1]), number<double>(columns[2]));
    if (!p.allFinite()) fail("the vertex is not finite");
    return p;
  }

 private:
  const fs::path& path_;
  char comment_;
  std::ifstream stream_;
  int number_ = 0;
  std::vector<std::string> words_;
};

/// Refuses a face with too few vertices or ones that do not exist.
void check_face(const LineReader& reader, const std::vector<int>& face, std::size_t num_vertices) {
  if (face.size() < 3)
    reader.fail(message("a face of ", face.size(), " vertices; three are needed"));
  for (int v : face) {
    if (v < 0 || v >= static_cast<int>(num_vertices)) {
      reader.fail(message("a face names vertex ", v, " (from 0), but there are ", num_vertices));
    }
  }
}

/// `count` and that many vertex numbers from word `first` on.
std::vector<int> counted_face(const LineReader& reader, std::size_t first) {
  const auto count = static_cast<std::size_t>(reader.count(first));
  if (reader.num_words() < first + 1 + count) {
    reader.fail(
        message("a face of ", count, " vertices names only ", reader.num_words() - first - 1));
  }
  std::vector<int> face(count);
  for (std::size_t k = 0; k < face.size(); ++k) face[k] = reader.number<int>(first + 1 + k);
  return face;
}

SurfaceMesh read_obj(const fs::path& path) {
  LineReader reader(path, '#');
  SurfaceMesh mesh;
  while (reader.next()) {
    if (reader.word(0) == "v") mesh.vertices.push_back(reader.point({1, 2, 3}));
    if (reader.word(0) != "f") continue;
    std::vector<int> face;
    for (std::size_t i = 1; i < reader.num_words(); ++i) {
      const std::string_view corner = reader.word(i);  // vertex[/texture[/normal]]
      const int number = reader.parse<int>(corner.substr(0, corner.find('/')));
      face.push_back(number < 0 ? static_cast<int>(mesh.vertices.size()) + number : number - 1);
    }
    check_face(reader, face, mesh.vertices.size());
    mesh.faces.push_back(std::move(face));
  }
  return mesh;
}

SurfaceMesh read_off(const fs::path& path) {
  LineReader reader(path, '#');
  reader.require_next("its header");
  std::size_t first = 0;
  if (reader.word(0).ends_with("OFF")) {
    first = 1;
    if (reader.num_words() == 1) {
      reader.require_next("its counts");
      first = 0;
    }
  }
  const int num_vertices = reader.count(first), num_faces = reader.count(first + 1);
  SurfaceMesh mesh;
  for (int v = 0; v < num_vertices; ++v) {
    reader.require_next("its last vertex");
    mesh.vertices.push_back(reader.point({0, 1, 2}));
  }
  for (int f = 0; f < num_faces; ++f) {
    reader.require_next("its last face");
    mesh.faces.push_back(counted_face(reader, 0));
    check_face(reader, mesh.faces.back(), mesh.vertices.size());
  }
  return mesh;
}

/// What the header of a .ply file says of the elements that count.
struct PlyHeader {
  struct Element {
    std::string name;
    int count = 0;
    std::vector<std::string> properties;
  };
  std::vector<Element> elements;
};

PlyHeader read_ply_header(LineReader& reader) {
  reader.require_next("its header");
  if (reader.word(0) != "ply") reader.fail("a .ply file begins with \"ply\"");
  PlyHeader header;
  while (true) {
    reader.require_next("\"end_header\"");
    const std::string& key = reader.word(0);
    if (key == "end_header") return header;
    if (key == "format" && reader.word(1) != "ascii") {
      reader.fail(message("the format ", reader.word(1),
                          " is not read; save the mesh as text "
                          "(ascii) or as .obj"));
    }
    if (key == "element") header.elements.push_back({reader.word(1), reader.count(2), {}});
    if (key != "property") continue;
    if (header.elements.empty()) reader.fail("a property before the first element");
    header.elements.back().properties.push_back(reader.word(reader.num_words() - 1));
  }
}

SurfaceMesh read_ply(const fs::path& path) {
  LineReader reader(path, 0);
  const PlyHeader header = read_ply_header(reader);
  SurfaceMesh mesh;
  for (const auto& element : header.elements) {
    const auto column = [&](const char* name) {
      const auto at = std::ranges::find(element.properties, name);
      if (at == element.properties.end()) {
        reader.fail(message("the header gives no property ", name, " of ", element.name));
      }
      return static_cast<std::size_t>(at - element.properties.begin());
    };
    std::array<std::size_t, 3> axes{};
    if (element.name == "vertex") axes = {column("x"), column("y"), column("z")};
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

void write_header(std::ostream& stream, Format format, const SurfaceMesh& mesh) {
  if (format == Format::kOff) {
    stream << "OFF\n" << mesh.vertices.size() << ' ' << mesh.faces.size() << " 0\n";
  } else if (format == Format::kPly) {
    stream << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.size()
           << "\nproperty double x\nproperty double y\nproperty double z\nelement face "
           << mesh.faces.size() << "\nproperty list int int vertex_indices\nend_header\n";
  }
}

}  // namespace

bool is_surface_mesh_file(const fs::path& path) { return format_of(path).has_value(); }

SurfaceMesh read_surface_mesh(const fs::path& path) {
  const Format format = known_format(path);
  SurfaceMesh mesh = format == Format::kObj   ? read_obj(path)
                     : format == Format::kOff ? read_off(path)
                                              : read_ply(path);
  if (mesh.vertices.empty()) throw InvalidInput(message(path.string(), ": the mesh has no vertex"));
  return mesh;
}

void write_surface_mesh(const fs::path& path, const SurfaceMesh& mesh) {
  const Format format = known_format(path);
  const bool is_obj = format == Format::kObj;
  std::ostringstream stream;
  stream.precision(17);
  write_header(stream, format, mesh);
  for (const auto& p : mesh.vertices) {
    stream << (is_obj ? "v " : "") << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  }
  for (const auto& face : mesh.faces) {
    if (is_obj) {
      stream << 'f';
    } else {
      stream << face.size();
    }
    for (int v : face) stream << ' ' << (is_obj ? v + 1 : v);
    stream << '\n';
  }
  write_whole_file(path, stream.str());
}

}  // namespace crease
