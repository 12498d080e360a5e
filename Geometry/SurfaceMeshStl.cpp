#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <sstream>

#include "Geometry/MeshLineReader.h"
#include "Geometry/SurfaceMeshFileForms.h"

namespace crease {
namespace {

constexpr std::size_t kHeaderBytes = 84;    // 80 of any kind, and the number of triangles
constexpr std::size_t kTriangleBytes = 50;  // normal, three corners, and 2 that mean nothing

/// Gives corners of the same coordinates the same number.
class CornerMerger {
 public:
  void add_triangle(const std::array<Point<3>, 3>& corners) {
    std::vector<int> face;
    for (const Point<3>& p : corners) {
      const auto [at, is_new] =
          numbers_.try_emplace({p[0], p[1], p[2]}, std::ssize(mesh_.vertices));
      if (is_new) mesh_.vertices.push_back(p);
      face.push_back(static_cast<int>(at->second));
    }
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) return;
    mesh_.faces.push_back(std::move(face));
  }
  SurfaceMesh take() && { return std::move(mesh_); }

 private:
  std::map<std::array<double, 3>, std::ptrdiff_t> numbers_;
  SurfaceMesh mesh_;
};

std::uint32_t integer_at(const std::string& bytes, std::size_t at) {
  std::uint32_t bits = 0;
  for (std::size_t k = 4; k-- > 0;) bits = bits << 8 | static_cast<std::uint8_t>(bytes[at + k]);
  return bits;
}

SurfaceMesh read_binary(const std::filesystem::path& path, const std::string& bytes) {
  CornerMerger merger;
  for (std::size_t at = kHeaderBytes; at < bytes.size(); at += kTriangleBytes) {
    std::array<Point<3>, 3> corners;
    for (std::size_t n = 0; n < 9; ++n) {
      const float value = std::bit_cast<float>(integer_at(bytes, at + 12 + 4 * n));
      corners[n / 3][static_cast<Eigen::Index>(n % 3)] = value;
      if (!std::isfinite(value)) {
        throw InvalidInput(message(path.string(), ": triangle ",
                                   (at - kHeaderBytes) / kTriangleBytes,
                                   " (from 0) has a corner that is not finite"));
      }
    }
    merger.add_triangle(corners);
  }
  return std::move(merger).take();
}

SurfaceMesh read_text(const std::filesystem::path& path) {
  LineReader reader(path, 0);
  reader.require_next("its header");
  if (reader.word(0) != "solid") {
    reader.fail(
        "an .stl file begins with \"solid\", or is binary with 84 bytes and 50 for every triangle; "
        "this "
        "one may be cut off");
  }
  CornerMerger merger;
  while (true) {
    reader.require_next("\"endsolid\"");
    if (reader.word(0) == "endsolid") return std::move(merger).take();
    if (reader.word(0) != "facet")
      reader.fail(message("\"", reader.word(0), "\" instead of \"facet\""));
    std::array<Point<3>, 3> corners;
    std::size_t count = 0;
    while (reader.word(0) != "endfacet") {
      reader.require_next("\"endfacet\"");
      if (reader.word(0) != "vertex") continue;
      if (count == corners.size()) reader.fail("a facet of more than three corners");
      corners[count++] = reader.point({1, 2, 3});
    }
    if (count < corners.size()) reader.fail(message("a facet of ", count, " corners"));
    merger.add_triangle(corners);
  }
}

}  // namespace

SurfaceMesh read_stl(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(stream), {});
  // Binary files may begin with "solid", too: their size tells.
  const bool binary = bytes.size() >= kHeaderBytes &&
                      bytes.size() == kHeaderBytes + kTriangleBytes * integer_at(bytes, 80);
  return binary ? read_binary(path, bytes) : read_text(path);
}

std::string stl_text(const SurfaceMesh& mesh) {
  std::ostringstream stream;
  stream.precision(17);
  stream << "solid crease\n";
  const auto write = [&](const char* word, const Point<3>& p) {
    stream << word << ' ' << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  };
  for (const auto& face : mesh.faces) {
    for (std::size_t k = 2; k < face.size(); ++k) {
      const std::array<Point<3>, 3> corners = {mesh.vertices[face[0]], mesh.vertices[face[k - 1]],
                                               mesh.vertices[face[k]]};
      const Vector<3> normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
      write("facet normal", normal.norm() > 0 ? normal.normalized() : Vector<3>::Zero());
      stream << "outer loop\n";
      for (const Point<3>& p : corners) write("vertex", p);
      stream << "endloop\nendfacet\n";
    }
  }
  stream << "endsolid crease\n";
  return stream.str();
}

}  // namespace crease
