#include "Geometry/SurfaceMeshFile.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "Core/Error.h"
#include "Core/WholeFile.h"
#include "Geometry/MeshLineReader.h"
#include "Geometry/SurfaceMeshFileForms.h"

namespace crease {
namespace {

namespace fs = std::filesystem;

enum class Format { kObj, kOff, kPly, kStl };

std::optional<Format> format_of(const fs::path& path) {
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending == ".obj") return Format::kObj;
  if (ending == ".off") return Format::kOff;
  if (ending == ".ply") return Format::kPly;
  if (ending == ".stl") return Format::kStl;
  return std::nullopt;
}

Format known_format(const fs::path& path) {
  if (const auto format = format_of(path)) return *format;
  throw InvalidInput(message(
      path.string(), ": the mesh format is not known; known are .obj, .off, .ply and .stl"));
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
                     : format == Format::kPly ? read_ply(path)
                                              : read_stl(path);
  if (mesh.vertices.empty()) throw InvalidInput(message(path.string(), ": the mesh has no vertex"));
  return mesh;
}

void write_surface_mesh(const fs::path& path, const SurfaceMesh& mesh) {
  const Format format = known_format(path);
  if (format == Format::kStl) {
    write_whole_file(path, stl_text(mesh));
    return;
  }
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
