// Transform files that ITK itself wrote (itk_write_transforms) are read, and points go where ITK takes them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <set>

#include "Core/Error.h"
#include "Testing/Interoperability/ItkPoints.h"
#include "Transforms/TransformFile.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kSame = 1e-9;  // mm

/// Written once for all tests.
class ItkReadTransform : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new testing::TemporaryFolder();
    const auto run = testing::run_program(ITK_WRITE_TRANSFORMS, {folder_->path().string()});
    ASSERT_EQ(run.code, 0) << run.err;
  }
  static void TearDownTestSuite() { delete folder_; }
  static std::filesystem::path file(const std::string& name) { return *folder_ / name; }

  template <int Dim>
  static void expect_same(const Transform<Dim>& transform, const std::string& name) {
    std::ifstream stream(file(name + ".points"));
    int count = 0;
    double largest = 0, farthest = 0;
    for (Point<Dim> x, y; stream; ++count) {
      for (double& c : x) stream >> c;
      for (double& c : y) stream >> c;
      if (!stream) break;
      largest = std::max(largest, (transform.map(x) - y).norm());
      farthest = std::max(farthest, (x - y).norm());
    }
    EXPECT_TRUE(farthest > 0.1 || name.ends_with("identity")) << name;  // the file says something
    EXPECT_EQ(count, 300) << name;
    EXPECT_LT(largest, kSame) << name;
  }

  /// All names of this dimension that have points, and the files of each.
  static std::set<std::string> names(int dimension) {
    std::set<std::string> result;
    for (const auto& entry : std::filesystem::directory_iterator(folder_->path())) {
      const auto& path = entry.path();
      const std::string name = path.stem().string();
      if (path.extension() == ".points" && name[0] == '0' + dimension) result.insert(name);
    }
    return result;
  }
  template <int Dim>
  static void expect_all_the_same() {
    EXPECT_EQ(names(Dim).size(), Dim == 2 ? 23U : 30U);
    for (const std::string& name : names(Dim)) {
      for (const char* ending : {".tfm", ".h5", ".mat"}) {
        if (!std::filesystem::exists(file(name + ending))) continue;
        SCOPED_TRACE(name + ending);
        const TransformFileInfo info = peek_transform(file(name + ending));
        EXPECT_EQ(info.in_dim, Dim);
        EXPECT_EQ(info.out_dim, Dim);
        expect_same<Dim>(*load_transform<Dim>(file(name + ending)), name);
      }
    }
  }

 private:
  static testing::TemporaryFolder* folder_;
};
testing::TemporaryFolder* ItkReadTransform::folder_ = nullptr;

TEST_F(ItkReadTransform, EveryClassInThePlane) { expect_all_the_same<2>(); }
TEST_F(ItkReadTransform, EveryClassInSpace) { expect_all_the_same<3>(); }

TEST_F(ItkReadTransform, TellsTypeAndForm) {
  const auto expect = [](const char* name, const char* type, const char* format) {
    const auto info = peek_transform(file(name));
    EXPECT_EQ(info.type, type) << name;
    EXPECT_EQ(info.format, format) << name;
  };
  expect("2-euler.tfm", "rigid", "ITK text");
  expect("3-similarity.h5", "affine", "ITK HDF5");
  expect("3-affine.mat", "affine", "ITK Matlab");
  expect("2-spline-2.h5", "spline", "ITK HDF5");
  expect("3-field.tfm", "displacement field", "ITK text");
  expect("3-composite.h5", "composite", "ITK HDF5");
}

// The contents tell the form, whatever the name.
TEST_F(ItkReadTransform, NamesMayBeOther) {
  for (const char* name : {"3-euler.tfm", "3-euler.h5"}) {
    const auto other = file("renamed");
    std::filesystem::copy_file(file(name), other,
                               std::filesystem::copy_options::overwrite_existing);
    expect_same<3>(*load_transform<3>(other), "3-euler");
  }
}

TEST_F(ItkReadTransform, BigEndianAndSingleMatlabFilesAreRead) {
  const std::string bytes = testing::read_text(file("2-affine.mat"));
  const auto header_end = [&](std::size_t at) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + at + 16, 4);
    return at + 20 + length;
  };
  std::string big;
  const auto turned = [&](std::size_t at, std::size_t width) {
    std::string word = bytes.substr(at, width);
    std::reverse(word.begin(), word.end());
    return word;
  };
  for (std::size_t at = 0; at < bytes.size();) {
    std::uint32_t rows = 0;
    std::memcpy(&rows, bytes.data() + at + 4, 4);
    big += std::string("\0\0\x03\xe8", 4);  // 1000
    for (std::size_t k = 1; k < 5; ++k) big += turned(at + 4 * k, 4);
    const std::size_t numbers = header_end(at);
    big += bytes.substr(at + 20, numbers - at - 20);
    for (std::size_t n = 0; n < rows; ++n) big += turned(numbers + 8 * n, 8);
    at = numbers + 8 * rows;
  }
  std::ofstream(file("big.mat"), std::ios::binary) << big;
  expect_same<2>(*load_transform<2>(file("big.mat")), "2-affine");
}

TEST_F(ItkReadTransform, DamagedFilesAreRefused) {
  const auto refused = [](const std::string& name, const std::string& bytes, const char* reason) {
    std::ofstream(file(name), std::ios::binary) << bytes;
    EXPECT_THAT([&] { load_transform<2>(file(name)); },
                ThrowsMessage<FileError>(
                    ::testing::AllOf(HasSubstr(file(name).string()), HasSubstr(reason))));
  };
  const std::string h5 = testing::read_text(file("2-composite.h5"));
  refused("half.h5", h5.substr(0, h5.size() / 2), "is not a complete HDF5 file");
  refused("text.h5", "no HDF5 at all\n", "is not an HDF5 file, though its name says so");
  std::string other = h5;
  for (auto at = other.find("TransformGroup"); at != std::string::npos;
       at = other.find("TransformGroup")) {
    other[at] = 'X';
  }
  refused("other.h5", other, "there is no group \"/TransformGroup\"");
  std::string unknown = testing::read_text(file("2-affine.h5"));
  unknown.replace(unknown.find("AffineTransform_"), 16, "UnheardTransform");
  refused("unknown.h5", unknown, "UnheardTransform");
  const std::string mat = testing::read_text(file("2-affine.mat"));
  refused("half.mat", mat.substr(0, mat.size() - 3), "is cut off");
  refused("other.mat", "MATLAB 5.0 MAT-file, Platform", "was saved by Matlab itself");
  refused("text.mat", "this is a text of many more than twenty bytes", "is no file of Matlab 4");
  refused("empty.tfm", "", "is empty");
  EXPECT_THAT([] { load_transform<2>(file("3-affine.h5")); },
              ThrowsMessage<FileError>(HasSubstr("holds a transform from 3D to 3D")));
  EXPECT_THAT([] { load_transform<2>(file("2-kernel.tfm")); },
              ThrowsMessage<FileError>(HasSubstr(
                  "the ThinPlateSplineKernelTransform_double_2_2 is of a class that crease has no "
                  "equal of")));
}

/// The chain of all kinds of files, through the command: points go where ITK takes them.
template <int Dim>
void warps_a_mixed_chain(const std::function<std::filesystem::path(const std::string&)>& file) {
  const std::string d = std::to_string(Dim) + "-";
  const std::vector<std::string> names = {d + "affine.mat", d + "field.mha", d + "composite.h5",
                                          d + "spline-3.tfm"};
  const std::vector<std::string> itk_files = {d + "affine.tfm", d + "field.tfm",
                                              d + "composite.tfm", d + "spline-3.tfm"};
  std::string text = Dim == 2 ? "x,y\n" : "x,y,z\n";
  std::vector<Point<Dim>> points;
  for (int k = 0; k < 40; ++k) {
    Point<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = 4 + 0.1 * ((7 * k + 11 * a) % 40);
    points.push_back(x);
    for (int a = 0; a < Dim; ++a) text += message(a > 0 ? "," : "", x[a]);
    text += "\n";
  }
  std::ofstream(file("in.csv")) << text;
  std::vector<std::string> arguments = {"warp",
                                        "--quiet",
                                        "--points",
                                        file("in.csv").string(),
                                        "--output-points",
                                        file("out.csv").string()};
  for (const std::string& name : names) {
    arguments.insert(arguments.end(), {"--transform", file(name).string()});
  }
  const auto run = testing::run_crease(arguments);
  ASSERT_EQ(run.code, 0) << run.err;
  std::istringstream rows(testing::read_text(file("out.csv")));
  std::string header;
  std::getline(rows, header);
  std::vector<Point<Dim>> mapped(points.size());
  for (auto& y : mapped) {
    for (double& c : y) {
      rows >> c;
      rows.ignore(1);
    }
  }
  for (const std::string& itk : itk_files) {
    const auto next = testing::mapped_by_itk<Dim>(file(itk), points);
    EXPECT_GT(testing::largest_distance<Dim>(points, next), 0.1) << itk;
    points = next;
  }
  EXPECT_LT(testing::largest_distance<Dim>(points, mapped), kSame);
}

TEST_F(ItkReadTransform, CommandWarpsAMixedChain) {
  warps_a_mixed_chain<2>(file);
  warps_a_mixed_chain<3>(file);
}

TEST_F(ItkReadTransform, CommandTakesFieldsOfEveryImageForm) {
  for (const char* d : {"2", "3"}) {
    std::string first;
    for (const char* ending : {".tfm", ".h5", ".mha", ".nrrd", ".nii.gz"}) {
      const std::string points =
          std::string(d) == "2" ? "x,y\n3,9.25\n5,14\n" : "x,y,z\n3,9.25,8\n5,14,9\n";
      std::ofstream(file("in.csv")) << points;
      const auto run = testing::run_crease(
          {"warp", "--quiet", "--transform", file(std::string(d) + "-field" + ending).string(),
           "--points", file("in.csv").string(), "--output-points", file("out.csv").string()});
      ASSERT_EQ(run.code, 0) << run.err;
      const std::string rows = testing::read_text(file("out.csv"));
      EXPECT_NE(rows, points);
      if (first.empty()) first = rows;
      std::istringstream a(first), b(rows);
      a.ignore(100, '\n');
      b.ignore(100, '\n');
      for (double x = 0, y = 0; a >> x && b >> y; a.ignore(1), b.ignore(1)) {
        EXPECT_NEAR(x, y, 1e-5) << ending;  // NIfTI keeps its geometry in single precision
      }
    }
  }
}

}  // namespace
}  // namespace crease
