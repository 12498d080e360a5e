#include "Geometry/SurfaceMeshFile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>

#include "Core/Error.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class SurfaceMeshFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("crease-mesh-") +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  void expect_refused(const std::string& name, const std::string& text,
                      const std::string& reason) const {
    const auto file = write(name, text);
    EXPECT_THAT([&] { read_surface_mesh(file); },
                ThrowsMessage<InvalidInput>(AllOf(HasSubstr(name), HasSubstr(reason))));
  }
  std::filesystem::path folder_;
};

}  // namespace

TEST_F(SurfaceMeshFile, WhatIsWrittenReadsBackToTheLastBit) {
  const SurfaceMesh mesh = {{{0.1, 1.0 / 3, -2e-17}, {1e300, 2, 3}, {4, 5, 6}, {7, 8, 9}},
                            {{0, 1, 2}, {3, 2, 1, 0}}};
  for (const char* name : {"m.obj", "m.off", "m.PLY"}) {
    write_surface_mesh(folder_ / name, mesh);
    const SurfaceMesh read = read_surface_mesh(folder_ / name);
    EXPECT_EQ(read.vertices, mesh.vertices) << name;
    EXPECT_EQ(read.faces, mesh.faces) << name;
  }
}

TEST_F(SurfaceMeshFile, ReadsWhatOtherProgramsWrite) {
  const auto obj = read_surface_mesh(
      write("a.obj",
            "# made by hand\r\nmtllib a.mtl\r\nv 0 0 0 1 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nvn 0 0 1\r\n"
            "vt 0 0\r\ng part\r\nf 1/1/1 2//1 3\r\nf -3 -1 -2\r\n"));
  EXPECT_EQ(obj.vertices.size(), 3U);
  EXPECT_THAT(obj.faces, ElementsAre(ElementsAre(0, 1, 2), ElementsAre(0, 2, 1)));
  const auto off = read_surface_mesh(
      write("a.off",
            "COFF 3 1 0 # counts\n\n0 0 0 255 0 0 255\n1 0 0 0 0 0 0\n0 1 0 9 9 9 9\n"
            "3 0 1 2 128 128 128\n"));
  EXPECT_THAT(off.faces, ElementsAre(ElementsAre(0, 1, 2)));
  const auto ply = read_surface_mesh(
      write("a.ply",
            "ply\nformat ascii 1.0\ncomment #1\nelement vertex 3\nproperty float nx\n"
            "property float z\nproperty float y\nproperty float x\nelement edge 1\n"
            "property int a\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
            "9 3 2 1\n9 6 5 4\n9 9 8 7\n0\n3 0 1 2\n"));
  EXPECT_EQ(ply.vertices[1], Point<3>(4, 5, 6));
  EXPECT_THAT(ply.faces, ElementsAre(ElementsAre(0, 1, 2)));
}

TEST_F(SurfaceMeshFile, ReadsBinaryPlyOfEitherOrderOfBytes) {
  const std::string elements =
      "element vertex 3\nproperty float x\nproperty double y\nproperty short z\n"
      "property list uchar uchar flags\nelement face 1\nproperty uchar red\n"
      "property list uchar int vertex_indices\nelement edge 1\nproperty int a\nend_header\n";
  for (const bool big : {false, true}) {
    std::string text =
        std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian 1.0\n" + elements;
    const auto put = [&](auto value) {
      std::array<char, sizeof(value)> bytes;
      std::memcpy(bytes.data(), &value, sizeof(value));
      if (big) std::reverse(bytes.begin(), bytes.end());  // tests run on little-endian machines
      text.append(bytes.begin(), bytes.end());
    };
    for (int v = 0; v < 3; ++v) {
      put(0.5f * static_cast<float>(v));
      put(0.1 * v);
      put(static_cast<std::int16_t>(-v));
      put(std::uint8_t{2});
      put(std::uint8_t{7});
      put(std::uint8_t{8});
    }
    put(std::uint8_t{255});
    put(std::uint8_t{3});
    for (const std::int32_t v : {2, 0, 1}) put(v);
    put(std::int32_t{5});
    const auto mesh = read_surface_mesh(write("b.ply", text));
    ASSERT_EQ(mesh.vertices.size(), 3U);
    EXPECT_EQ(mesh.vertices[2], Point<3>(1, 0.1 * 2, -2));
    EXPECT_THAT(mesh.faces, ElementsAre(ElementsAre(2, 0, 1)));
    expect_refused("b.ply", text.substr(0, text.size() - 1), "ends before its last element");
    const std::size_t third = text.size() - 8;  // the face's last vertex number
    text[third + (big ? 3 : 0)] = 9;
    expect_refused("b.ply", text, "a face names vertex 9 (from 0)");
  }
}

TEST_F(SurfaceMeshFile, StlCornersBecomeVertices) {
  const SurfaceMesh mesh = {{{0.1, 1.0 / 3, 0}, {1, 0, 0}, {1, 1, 0.25}, {0, 1, 0}},
                            {{0, 1, 2, 3}}};
  write_surface_mesh(folder_ / "m.stl", mesh);
  const SurfaceMesh read = read_surface_mesh(folder_ / "m.stl");
  EXPECT_EQ(read.vertices, mesh.vertices);  // to the last bit: it is text
  EXPECT_THAT(read.faces, ElementsAre(ElementsAre(0, 1, 2), ElementsAre(0, 2, 3)));

  std::string binary = "solid, but binary" + std::string(63, ' ');
  const auto put = [&](auto value) {
    binary.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  put(std::uint32_t{3});
  const std::vector<std::array<int, 3>> triangles = {{0, 1, 2}, {0, 2, 3}, {3, 3, 1}};
  for (const auto& triangle : triangles) {
    for (int k = 0; k < 3; ++k) put(0.0f);
    for (const int v : triangle) {
      for (const double c : mesh.vertices[v]) put(static_cast<float>(c));
    }
    put(std::uint16_t{0});
  }
  const SurfaceMesh from_binary = read_surface_mesh(write("b.stl", binary));
  ASSERT_EQ(from_binary.vertices.size(), 4U);
  EXPECT_EQ(from_binary.vertices[0], Point<3>(0.1f, 1.0f / 3, 0));
  EXPECT_EQ(from_binary.faces, read.faces);  // without the triangle of two corners
  expect_refused("b.stl", binary.substr(0, 200), "this one may be cut off");
  expect_refused("t.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n",
                 "ends before \"endfacet\"");
  expect_refused("t.stl", "solid a\nfacet\nvertex 0 0 0\nendfacet\nendsolid\n",
                 "line 4: a facet of 1 corners");
  expect_refused("t.stl", "solid a\nvertex 0 0 0\n", "line 2: \"vertex\" instead of \"facet\"");
}

TEST_F(SurfaceMeshFile, SaysWhereAFileIsWrong) {
  expect_refused("a.obj", "v 0 0\n", "line 1: there is no word 4");
  expect_refused("a.obj", "v 0 0 zero\n", "line 1: \"zero\" is not a number");
  expect_refused("a.obj", "v 0 0 nan\n", "line 1: the vertex is not finite");
  expect_refused("a.obj", "v 0 0 0\nf 1 1 2\n", "line 2: a face names vertex 1 (from 0)");
  expect_refused("a.obj", "v 0 0 0\nf 1 1\n", "line 2: a face of 2 vertices");
  expect_refused("a.obj", "", "no vertex");
  expect_refused("a.off", "OFF\n2 0 0\n0 0 0\n", "ends before its last vertex");
  expect_refused("a.off", "OFF\n-2 0 0\n", "line 2: a count of -2");
  expect_refused("a.off", "OFF\n1 1 0\n0 0 0\n2000000000 0 0\n", "line 4: a face of 2000000000");
  expect_refused("a.ply", "ply\nformat binary_middle_endian 1.0\nend_header\n",
                 "save the mesh as text");
  expect_refused("a.ply",
                 "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
                 "no property y");
  expect_refused("a.wrl", "#VRML\n", ".obj, .off, .ply and .stl");
  EXPECT_THAT([&] { read_surface_mesh(folder_ / "none.obj"); },
              ThrowsMessage<FileError>(HasSubstr("none.obj")));
  EXPECT_THAT([&] { write_surface_mesh(folder_ / "none/a.obj", {}); },
              ThrowsMessage<FileError>(HasSubstr("none/a.obj")));
}

}  // namespace crease
