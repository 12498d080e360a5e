// Transform files that ITK itself wrote (itk_write_transforms) are read, and points go where ITK takes them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "Images/ImageFile.h"
#include "Testing/Interoperability/ItkPoints.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/DisplacementFieldTransform.h"
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
    double largest = 0;
    for (Point<Dim> x, y; stream; ++count) {
      for (double& c : x) stream >> c;
      for (double& c : y) stream >> c;
      if (!stream) break;
      largest = std::max(largest, (transform.map(x) - y).norm());
    }
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
    EXPECT_GE(names(Dim).size(), Dim == 2 ? 21U : 29U);
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

}  // namespace
}  // namespace crease
