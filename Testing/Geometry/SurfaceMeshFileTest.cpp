#include "Geometry/SurfaceMeshFile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
  expect_refused("a.ply", "ply\nformat binary_little_endian 1.0\nend_header\n",
                 "save the mesh as text");
  expect_refused("a.ply",
                 "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
                 "no property y");
  expect_refused("a.stl", "solid\n", ".obj, .off and .ply");
  EXPECT_THAT([&] { read_surface_mesh(folder_ / "none.obj"); },
              ThrowsMessage<FileError>(HasSubstr("none.obj")));
  EXPECT_THAT([&] { write_surface_mesh(folder_ / "none/a.obj", {}); },
              ThrowsMessage<FileError>(HasSubstr("none/a.obj")));
}

}  // namespace crease
