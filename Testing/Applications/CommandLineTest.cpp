#include "Applications/CommandLine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <new>

#include "Testing/TemporaryFolder.h"

namespace crease {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// A command with two subcommands, run in this process.
struct Fixture : ::testing::Test {
  std::string input;
  int degree = 3;
  std::optional<double> mesh_size;
  std::optional<int> triangles;
  std::string metric = "ssd";
  bool no_creases = false;
  std::vector<double> spacing;
  std::vector<std::string> chain;
  std::string config;
  std::function<ExitCode()> body = [] { return ExitCode::kSuccess; };
  bool ran = false;
  std::string out, err;

  int run(std::vector<std::string> arguments) {
    const std::vector<Subcommand> subcommands = {
        {.name = "register",
         .summary = "Registers.",
         .details = "Example: crease register --fixed f.png",
         .options =
             {{.name = "fixed",
               .target = &input,
               .placeholder = "FILE",
               .help = "Fixed image",
               .required = true},
              {.name = "degree", .target = &degree, .minimum = 1, .maximum = 5},
              {.name = "mesh-size", .target = &mesh_size, .minimum = 0, .open_minimum = true},
              {.name = "triangles", .target = &triangles, .minimum = 1},
              {.name = "metric", .target = &metric, .choices = {"ssd", "none"}},
              {.name = "no-creases", .target = &no_creases},
              {.name = "spacing", .target = &spacing},
              {.name = "transform", .target = &chain}},
         .exclusive = {{"mesh-size", "triangles"}},
         .run =
             [&](const std::string& effective) {
               ran = true;
               config = effective;
               return body();
             }},
        {.name = "warp",
         .summary = "Warps.",
         .details = "",
         .options = {},
         .run = [](const std::string&) { return ExitCode::kGateFailed; }}};
    arguments.insert(arguments.begin(), "crease");
    std::vector<const char*> argv;
    for (const auto& argument : arguments) argv.push_back(argument.c_str());
    ran = false;
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const int code =
        run_command(static_cast<int>(argv.size()), argv.data(), subcommands, "crease 9.8.7");
    out = ::testing::internal::GetCapturedStdout();
    err = ::testing::internal::GetCapturedStderr();
    return code;
  }

  /// Expects exit code 2 and one line that holds the text, without running anything.
  void expect_usage_error(const std::vector<std::string>& arguments, const std::string& text) {
    EXPECT_EQ(run(arguments), 2) << text;
    EXPECT_FALSE(ran);
    EXPECT_THAT(err, HasSubstr(text));
    EXPECT_EQ(std::ranges::count(err, '\n'), 1) << err;
    EXPECT_EQ(out, "");
  }
};
using CommandLine = Fixture;

TEST_F(CommandLine, SetsOptions) {
  EXPECT_EQ(run({"register", "--fixed", "f.png", "--degree=2", "--mesh-size", "12.5", "--spacing",
                 "0.5,2", "--no-creases", "--transform", "a", "--transform", "b"}),
            0);
  EXPECT_TRUE(ran);
  EXPECT_EQ(input, "f.png");
  EXPECT_EQ(degree, 2);
  EXPECT_EQ(mesh_size, 12.5);
  EXPECT_TRUE(no_creases);
  EXPECT_THAT(spacing, ElementsAre(0.5, 2));
  EXPECT_THAT(chain, ElementsAre("a", "b"));
  EXPECT_EQ(err, "");
}

TEST_F(CommandLine, RefusesWhatItDoesNotKnowAndNamesTheNearest) {
  expect_usage_error({"register", "--fixed", "f", "--metrc", "ssd"},
                     "crease register: the option --metrc is unknown; did you mean --metric?");
  expect_usage_error({"register", "--fixed", "f", "--mesh_size=3"}, "did you mean --mesh-size?");
  expect_usage_error({"register", "--fixed", "f", "--orientations", "exact"},
                     "the option --orientations is unknown");
  expect_usage_error({"register", "--fixed", "f", "stray"}, "the argument \"stray\"");
  expect_usage_error({"register", "--fixed", "f", "--metric", "mi"},
                     "--metric: \"mi\" is unknown; It takes ssd or none.");
  expect_usage_error({"regster"},
                     "crease: \"regster\" is not a subcommand; did you mean register?");
  expect_usage_error({"elastic", "--fixed", "f"}, "\"elastic\" is not a subcommand");
  expect_usage_error({}, "name a subcommand, register or warp");
}

TEST_F(CommandLine, ChecksValues) {
  expect_usage_error({"register"}, "--fixed FILE is needed");
  expect_usage_error({"register", "--fixed", "f", "--degree", "6"},
                     "--degree: \"6\" is not a whole number from 1 to 5.");
  expect_usage_error({"register", "--fixed", "f", "--degree", "2.5"}, "not a whole number");
  expect_usage_error({"register", "--fixed", "f", "--degree", "nan"}, "not a whole number");
  expect_usage_error({"register", "--fixed", "f", "--mesh-size", "0"},
                     "--mesh-size: \"0\" is not a number above 0.");
  expect_usage_error({"register", "--fixed", "f", "--mesh-size", "-1"}, "not a number above 0");
  expect_usage_error({"register", "--fixed", "f", "--mesh-size", "inf"}, "not a number above 0");
  expect_usage_error({"register", "--fixed", "f", "--mesh-size", "12mm"},
                     "\"12mm\" is not a number");
  expect_usage_error({"register", "--fixed", "--degree", "2"}, "--fixed needs a value");
  expect_usage_error({"register", "--fixed", ""}, "--fixed: the value is empty");
  expect_usage_error({"register", "--degree"}, "--degree");
  expect_usage_error({"register", "--fixed", "a", "--fixed", "b"}, "--fixed");
  expect_usage_error({"register", "--fixed", "f", "--mesh-size", "3", "--triangles", "100"},
                     "--mesh-size and --triangles exclude each other");
}

TEST_F(CommandLine, ReadsAConfigurationBeforeAndAfterTheSubcommand) {
  const testing::TemporaryFolder folder;
  const std::string file = folder.write(
      "c.toml",
      "[register]\nfixed = \"f #1.png\"\ndegree = 4\nno-creases = false\nmesh-size = 7\n");
  ASSERT_EQ(run({"--config", file, "register"}), 0) << err;
  EXPECT_EQ(input, "f #1.png");
  EXPECT_EQ(degree, 4);
  EXPECT_FALSE(no_creases);
  ASSERT_EQ(run({"register", "--config", file, "--degree", "2"}), 0) << err;
  EXPECT_EQ(degree, 2);  // the command line wins
  EXPECT_EQ(mesh_size, 7);
  mesh_size.reset();
  ASSERT_EQ(run({"register", "--config", file, "--triangles", "50"}), 0) << err;
  EXPECT_EQ(mesh_size, std::nullopt);  // also over an option that excludes it
  expect_usage_error({"--config", file, "register", "--config", file}, "--config is given twice");
  expect_usage_error({"register", "--config", (folder / "none.toml").string()}, "none.toml");
}

TEST_F(CommandLine, RefusesAWrongConfiguration) {
  const testing::TemporaryFolder folder;
  const auto expect_error = [&](const std::string& text, const std::string& expected) {
    const std::string file = folder.write("c.toml", "[register]\n" + text + "\n");
    expect_usage_error({"register", "--fixed", "f", "--config", file}, expected);
  };
  expect_error("mesh_size = 3",
               "c.toml, line 2: the key mesh_size is unknown to crease register; "
               "did you mean mesh-size?");
  expect_error("degree = 9", "c.toml, line 2: degree: \"9\" is not a whole number from 1 to 5.");
  expect_error("metric = \"mi\"", "line 2: metric: \"mi\" is unknown");
  expect_error("degree = [1, 2]", "takes one value, not 2");
  expect_error("no-creases = 1", "is not true or false");
}

TEST_F(CommandLine, WritesAConfigurationThatRepeatsTheCall) {
  const testing::TemporaryFolder folder;
  ASSERT_EQ(run({"register", "--fixed", "f.png", "--spacing", "0.1,0.3", "--no-creases"}), 0);
  const std::string first = config;
  no_creases = false;
  spacing.clear();
  input = "";
  ASSERT_EQ(run({"register", "--config", folder.write("c.toml", first)}), 0) << err;
  EXPECT_EQ(config, first);
  EXPECT_TRUE(no_creases);
  EXPECT_THAT(spacing, ElementsAre(0.1, 0.3));
}

TEST_F(CommandLine, PrintsHelpAndVersion) {
  EXPECT_EQ(run({"register", "--help"}), 0);
  EXPECT_FALSE(ran);
  for (const char* text : {"--fixed FILE", "--degree", "ssd|none", "--config FILE", "Example:"}) {
    EXPECT_THAT(out, HasSubstr(text));
  }
  EXPECT_EQ(run({"--help"}), 0);
  EXPECT_THAT(out, HasSubstr("warp"));
  EXPECT_EQ(run({"--version"}), 0);
  EXPECT_EQ(out, "crease 9.8.7\n");
}

TEST_F(CommandLine, TurnsExceptionsIntoExitCodes) {
  const auto expect_code = [&](int code, std::function<ExitCode()> thrower, const char* text) {
    body = std::move(thrower);
    EXPECT_EQ(run({"register", "--fixed", "f"}), code);
    EXPECT_THAT(err, StartsWith("crease register: "));
    EXPECT_THAT(err, HasSubstr(text));
  };
  expect_code(
      2, []() -> ExitCode { throw UsageError("option"); }, "option");
  expect_code(
      3, []() -> ExitCode { throw InvalidInput("data"); }, "data");
  expect_code(
      3, []() -> ExitCode { throw FileError("file"); }, "file");
  expect_code(
      4, []() -> ExitCode { throw std::bad_alloc(); }, "out of memory");
  expect_code(
      5, []() -> ExitCode { throw SolverError("singular"); }, "singular");
  expect_code(
      70, []() -> ExitCode { throw std::logic_error("oops"); }, "internal error: oops");
  EXPECT_EQ(run({"warp"}), 1);
  EXPECT_EQ(err, "");
}

}  // namespace
}  // namespace crease
