#include "Applications/OutputFolder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Applications/ExitCode.h"
#include "Testing/TemporaryFolder.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(OutputFolder, RemovesAnEarlierResultAndUnfinishedFiles) {
  const testing::TemporaryFolder folder;
  folder.write("result.json", "{}");
  folder.write(".crease-aB3dEf/jacobian.mha", "half");
  folder.write("pictures/.crease-gH5iJk/grid.png", "half");
  folder.write("mine.txt", "kept");
  folder.write(".crease-settings", "kept");
  const OutputFolder output(folder.path());
  EXPECT_FALSE(std::filesystem::exists(folder / "result.json"));
  for (const char* name : {".crease-aB3dEf", "pictures/.crease-gH5iJk"}) {
    EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
  }
  for (const char* name : {"mine.txt", ".crease-settings"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  }
}

TEST(OutputFolder, ShowsAFileOnlyWhenItIsComplete) {
  const testing::TemporaryFolder folder;
  const OutputFolder output(folder / "new/deep");
  const auto file = folder / "new/deep/pictures/a.nii.gz";
  output.write("pictures/a.nii.gz", [&](const std::filesystem::path& temporary) {
    EXPECT_TRUE(temporary.string().ends_with(".nii.gz"));
    std::ofstream(temporary) << "content";
    EXPECT_FALSE(std::filesystem::exists(file));
  });
  EXPECT_EQ(testing::read_text(file), "content");
  EXPECT_THROW(output.write("b.txt",
                            [](const std::filesystem::path& temporary) {
                              std::ofstream(temporary) << "half";
                              throw InvalidInput("stop");
                            }),
               InvalidInput);
  output.finish("{}\n");
  EXPECT_EQ(testing::read_text(folder / "new/deep/result.json"), "{}\n");
  int count = 0;
  for ([[maybe_unused]] const auto& entry :
       std::filesystem::recursive_directory_iterator(folder / "new/deep")) {
    ++count;
  }
  EXPECT_EQ(count, 3);  // pictures, a.nii.gz, result.json: nothing half done is left
}

TEST(OutputFolder, RemovesAnEarlierFileButNoInput) {
  const testing::TemporaryFolder folder;
  folder.write("old.tfm", "of another run");
  const std::string input = folder.write("input.tfm", "mine");
  const OutputFolder output(folder.path(), {input});
  output.remove("old.tfm");
  output.remove("never-there.tfm");
  EXPECT_FALSE(std::filesystem::exists(folder / "old.tfm"));
  EXPECT_THAT([&] { output.remove("input.tfm"); },
              ThrowsMessage<UsageError>(HasSubstr("input.tfm is an input of this run")));
  EXPECT_TRUE(std::filesystem::exists(input));
}

TEST(OutputFolder, RemovesEarlierFilesByTheirNumbers) {
  const testing::TemporaryFolder folder;
  for (const char* name : {"warped-3.mha", "warped-12.nii.gz"}) folder.write(name, "old");
  const std::vector<std::string> others = {"warped.mha",    "warped-2.mha", "warped-3",
                                           "warped-03.mha", "warped-b.mha", "moving-3.mha"};
  for (const std::string& name : others) folder.write(name, "kept");
  folder.write("warped-7.mha", "input");
  const std::string input = (folder / "warped-7.mha").string();
  OutputFolder(folder.path(), {input}).remove_numbered("warped", 3);
  EXPECT_TRUE(std::filesystem::exists(input));
  for (const char* name : {"warped-3.mha", "warped-12.nii.gz"}) {
    EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
  }
  for (const std::string& name : others) {
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  }
}

TEST(OutputFolder, SaysWhenItCannotBeMade) {
  const testing::TemporaryFolder folder;
  const std::string file = folder.write("file", "");
  EXPECT_THAT([&] { OutputFolder output(file); },
              ThrowsMessage<UsageError>(HasSubstr("--output " + file)));
  EXPECT_THAT([&] { OutputFolder output(folder / "file/below"); },
              ThrowsMessage<UsageError>(HasSubstr("cannot be made")));
}

TEST(OutputFolder, RefusesToOverwriteItsInputs) {
  const testing::TemporaryFolder folder;
  const std::string input = folder.write("warped.mha", "image");
  const OutputFolder output(folder.path(), {input});
  EXPECT_THAT([&] { output.write_text("warped.mha", "new"); },
              ThrowsMessage<UsageError>(HasSubstr("warped.mha")));
  EXPECT_EQ(testing::read_text(input), "image");
}

}  // namespace
}  // namespace crease
