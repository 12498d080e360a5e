// Nothing of an input file's header but its geometry reaches an output.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "Images/ImageFile.h"
#include "Testing/Applications/CommandRunner.h"
#include "Testing/Applications/TemporaryFolder.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_crease;

/// Every file below the folder, its path and content.
void expect_no_file_holds(const std::filesystem::path& folder, const std::string& text) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    EXPECT_EQ(testing::read_text(entry.path()).find(text), std::string::npos)
        << entry.path() << " holds " << text;
  }
}

/// A MetaImage whose header says more than geometry.
std::string image_with_identity(const testing::TemporaryFolder& folder, const std::string& name,
                                int shift) {
  std::string text =
      "ObjectType = Image\nNDims = 2\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
      "PatientName = Doe^Jane\nStudyDate = 19680229\nComment = secret-4711\nElementSpacing = 1 1\n"
      "DimSize = 32 32\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
  for (int j = 0; j < 32; ++j) {
    for (int i = 0; i < 32; ++i) {
      const int x = i - 16 - shift, y = j - 14;
      text += static_cast<char>(x * x + 2 * y * y < 80 ? 100 + 2 * (j % 5) : 10);
    }
  }
  return folder.write(name, text);
}

TEST(Privacy, HeadersOfMetaImagesStayBehind) {
  const testing::TemporaryFolder folder;
  const std::string fixed = image_with_identity(folder, "fixed.mha", 0);
  const std::string moving = image_with_identity(folder, "moving.mha", 1);
  const std::string output = (folder / "out").string();
  const auto run = run_crease({"register", "--fixed", fixed, "--moving", moving, "--mesh-size",
                               "12", "--output", output, "--quiet", "--levels", "1"});
  ASSERT_EQ(run.code, 0) << run.err;
  for (const char* text : {"Doe", "Jane", "19680229", "secret-4711"}) {
    expect_no_file_holds(output, text);
  }
}

TEST(Privacy, HeadersOfDicomFilesStayBehind) {
  const std::string file = testing::shared_file("readers/MR_small.dcm");
  if (file.empty()) GTEST_SKIP() << "the DICOM file is not there";
  // What the file does say about its patient.
  const std::string content = testing::read_text(file);
  ASSERT_THAT(content, HasSubstr("CompressedSamples^MR1"));
  ASSERT_THAT(content, HasSubstr("20040826"));
  const testing::TemporaryFolder folder;
  const std::string output = (folder / "out").string();
  const auto run = run_crease({"register", "--fixed", file, "--moving", file, "--transform",
                               "rigid", "--init", "identity", "--output", output, "--quiet"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "out/warped.mha"));
  for (const char* text : {"CompressedSamples", "20040826", "4MR1", "TOSHIBA"}) {
    expect_no_file_holds(output, text);
  }
}

}  // namespace
}  // namespace crease
