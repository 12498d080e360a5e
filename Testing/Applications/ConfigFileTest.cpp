#include "Applications/ConfigFile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Applications/ExitCode.h"
#include "Testing/TemporaryFolder.h"

namespace crease {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const std::vector<std::string> kSections = {"register", "warp"};

struct Values {
  std::string name;
  std::optional<std::string> note;
  double weight = 1;
  std::optional<double> size;
  int degree = 3;
  bool creases = false;
  std::vector<double> spacing;
  std::vector<std::string> chain;

  std::vector<Option> options() {
    return {{.name = "name", .target = &name},       {.name = "note", .target = &note},
            {.name = "weight", .target = &weight},   {.name = "size", .target = &size},
            {.name = "degree", .target = &degree},   {.name = "no-creases", .target = &creases},
            {.name = "spacing", .target = &spacing}, {.name = "transform", .target = &chain}};
  }
};

// What the argument parser's own reader gets wrong: #, empty texts, false flags; and numbers to the bit.
TEST(ConfigFile, GivesBackExactlyWhatItWrote) {
  Values written;
  written.name = "a #1 \"quoted\" [x, y] \\ = file.png";
  written.weight = 0.1 + 0.2;
  written.size = 1e-300;
  written.degree = -4;
  written.spacing = {0.5, 1.0 / 3.0};
  written.chain = {"first, one.json", "second#.json"};
  const testing::TemporaryFolder folder;
  const std::string file = folder.write("c.toml", write_config("register", written.options()));

  Values read;
  read.creases = true;
  const auto options = read.options();
  for (const ConfigEntry& entry : read_config(file, "register", kSections)) {
    const auto option = std::ranges::find(options, entry.key, &Option::name);
    ASSERT_NE(option, options.end()) << entry.key;
    assign(*option, entry.values, entry.key);
  }
  EXPECT_EQ(read.name, written.name);
  EXPECT_EQ(read.note, std::nullopt);
  EXPECT_EQ(read.weight, written.weight);
  EXPECT_EQ(read.size, written.size);
  EXPECT_EQ(read.degree, written.degree);
  EXPECT_FALSE(read.creases);
  EXPECT_EQ(read.spacing, written.spacing);
  EXPECT_EQ(read.chain, written.chain);
}

TEST(ConfigFile, PassesOverOtherSections) {
  const testing::TemporaryFolder folder;
  const std::string file =
      folder.write("c.toml", "[warp]\nwhatever = 1\n[register]\nfixed = \"f\"\n");
  const auto entries = read_config(file, "register", kSections);
  ASSERT_EQ(entries.size(), 1u);
  EXPECT_EQ(entries[0].key, "fixed");
  EXPECT_THAT(entries[0].values, ElementsAre("f"));
  EXPECT_EQ(entries[0].line, 4);
}

TEST(ConfigFile, SaysWhereItIsWrong) {
  const testing::TemporaryFolder folder;
  const auto error = [&](const std::string& text, const std::string& expected) {
    const std::string file = folder.write("c.toml", text);
    EXPECT_THAT([&] { read_config(file, "register", kSections); },
                ThrowsMessage<UsageError>(HasSubstr(expected)))
        << text;
  };
  error("[register]\nfixed = \n", "c.toml, line 2");
  error("degree = 3\n", "line 1: degree stands outside a section; put it below [register]");
  error("\n[regster]\ndegree = 3\n",
        "line 2: the section [regster] is unknown; did you mean [register]?");
  error("[register]\nfixed = 2024-01-01\n", "line 2: fixed: the value must be");
  error("[register]\nfixed = { a = 1 }\n", "line 2: fixed: the value must be");
  EXPECT_THAT([&] { read_config(folder / "none.toml", "register", kSections); },
              ThrowsMessage<UsageError>(HasSubstr("none.toml: the file cannot be read")));
  EXPECT_THROW(read_config(folder.path(), "register", kSections), UsageError);
}

}  // namespace
}  // namespace crease
