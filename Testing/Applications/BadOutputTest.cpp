// Results that cannot be written: the option is named, before the work is done where that can be known,
// and nothing is left half written.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>

#include "Testing/Applications/RegisterFixture.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/TransformFile.h"

namespace crease {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_crease;

class BadOutput : public testing::RegisterFixture {
 protected:
  /// Expects one line on the error stream, nothing on the other, and no new file in the test's folder.
  void expect_refused(const std::vector<std::string>& arguments, int code,
                      const std::vector<std::string>& texts) const {
    const auto before = files();
    const auto run = run_crease(arguments);
    EXPECT_EQ(run.code, code) << run.err;
    for (const auto& text : texts) EXPECT_THAT(run.err, HasSubstr(text));
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_EQ(files(), before);
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
      names.push_back(std::filesystem::relative(entry.path(), folder.path()).string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }
  void expect_nothing_unfinished(const testing::CommandResult& refused) const {
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
    EXPECT_THAT(refused.err, Not(HasSubstr("unfinished")));
    EXPECT_FALSE(std::filesystem::exists(folder / "out/result.json"));
    EXPECT_THAT(files(), Each(Not(HasSubstr(".crease-"))));
  }
  std::string path(const std::string& name) const { return (folder / name).string(); }
  std::string transform() const {
    save_transform(AffineTransform<2>(), folder / "t.json");
    return path("t.json");
  }
};

// A folder below a file cannot be made; /proc exists, and nothing can be written there.
TEST_F(BadOutput, FoldersOfEverySubcommandThatTakesOne) {
  const std::string below = folder.write("file", "kept") + "/out";
  const std::string fixed = image("fixed.mha"), moving = image("moving.mha");
  for (const std::string& output : {below, std::string("/proc")}) {
    expect_refused(
        {"register", "--fixed", fixed, "--moving", moving, "--output", output, "--quiet"}, 2,
        {"crease register: --output " + output});
    expect_refused({"phantom", "square", "--size", "64", "--output", output, "--quiet"}, 2,
                   {"crease phantom: --output " + output});
    expect_refused(
        {"evaluate", "--displacement", image("truth.mha"), "--output", output, "--quiet"}, 2,
        {"crease evaluate: --output " + output});
  }
  EXPECT_EQ(testing::read_text(folder / "file"), "kept");
}

TEST_F(BadOutput, FilesOfWarp) {
  const std::string t = transform(), fixed = image("fixed.mha");
  const std::string points = folder.write("points.csv", "x,y\n1,2\n");
  std::filesystem::create_directory(folder / "folder");
  for (const std::string& name : {std::string("nowhere/file"), std::string("folder")}) {
    const std::string reason = name == "folder" ? "this is a folder" : "there is no folder";
    const std::string file = path(name);
    expect_refused({"warp", "--transform", t, "--points", points, "--output-points", file}, 2,
                   {"--output-points " + file, reason});
    expect_refused({"warp", "--transform", t, "--reference", fixed, "--displacement", file}, 2,
                   {"--displacement " + file, reason});
    expect_refused(
        {"warp", "--transform", t, "--reference", fixed, "--moving", fixed, "--output-image", file},
        2, {"--output-image " + file, reason});
  }
  expect_refused(
      {"warp", "--transform", t, "--reference", fixed, "--displacement", "/proc/u.mha", "--quiet"},
      3, {"/proc/u.mha"});
  expect_refused(
      {"warp", "--transform", t, "--points", points, "--output-points", "/proc/p.csv", "--quiet"},
      3, {"/proc/p.csv: nothing can be written"});
}

TEST_F(BadOutput, FormatsThatCannotHoldTheResult) {
  const std::string t = transform(), fixed = image("fixed.mha");
  const auto warp = [&](const char* option, const std::string& file) {
    std::vector<std::string> arguments = {"warp", "--transform", t,    "--reference",
                                          fixed,  option,        file, "--quiet"};
    if (std::string(option) == "--output-image") {
      arguments.insert(arguments.end(), {"--moving", fixed});
    }
    return arguments;
  };
  expect_refused(warp("--output-image", path("w.dcm")), 3, {path("w.dcm") + ": ", "DICOM"});
  expect_refused(warp("--output-image", path("w.gif")), 3,
                 {path("w.gif") + ": ", "format is not known"});
  expect_refused(warp("--displacement", path("u.png")), 3, {path("u.png") + ": ", ".mha"});
}

TEST_F(BadOutput, ResultThatCannotTakeItsPlace) {
  std::filesystem::create_directories(folder / "out/displacement.mha/occupied");
  const auto refused = run({"--levels", "1"});
  EXPECT_EQ(refused.code, 3);
  EXPECT_THAT(refused.err, HasSubstr("out/displacement.mha: "));
  expect_nothing_unfinished(refused);
}

// Files may grow to 20 kB only, as if the disk were full then; a displacement field needs 64 kB.
TEST_F(BadOutput, FullDisk) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{20000, before.rlim_max};
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);  // writing fails instead; inherited
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto refused = run({"--levels", "1"});
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(refused.code, 3);
  EXPECT_THAT(refused.err, HasSubstr((folder / "out/displacement.mha").string() + ": "));
  expect_nothing_unfinished(refused);
}

}  // namespace
}  // namespace crease
