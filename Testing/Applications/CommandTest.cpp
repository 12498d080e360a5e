// The command as a whole, whatever the subcommand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Testing/Applications/CommandRunner.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using testing::run_crease;

TEST(Command, VersionNamesBuildLibrariesAndLicence) {
  const auto run = run_crease({"--version"});
  EXPECT_EQ(run.code, 0);
  for (const char* text : {"crease 0.", "Build: ", "ITK 5.", "CGAL 5.", "Eigen 3.", "SuiteSparse ",
                           "GNU General Public License, version 3 or later"}) {
    EXPECT_THAT(run.out, HasSubstr(text));
  }
}

TEST(Command, EverySubcommandExplainsItselfWithAnExample) {
  for (const char* name : {"register", "warp", "info", "phantom", "evaluate"}) {
    const auto run = run_crease({name, "--help"});
    EXPECT_EQ(run.code, 0);
    EXPECT_EQ(run.err, "");
    for (const std::string& text : {std::string("Example"), std::string("crease ") + name,
                                    std::string("--config"), std::string("--threads")}) {
      EXPECT_THAT(run.out, HasSubstr(text)) << name;
    }
  }
}

// What later versions will know is refused now, never ignored.
TEST(Command, RefusesWhatBelongsToLaterVersions) {
  const std::vector<std::string> base = {"register", "--fixed", "a", "--moving", "b", "-o", "c"};
  for (const auto& extra : std::vector<std::vector<std::string>>{{"--orientations", "exact"},
                                                                 {"--slide-labels", "l.mha"},
                                                                 {"--transform", "demons"},
                                                                 {"--transform", "syn"}}) {
    auto arguments = base;
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    const auto run = run_crease(arguments);
    EXPECT_EQ(run.code, 2) << ::testing::PrintToString(extra);
    EXPECT_THAT(run.err, HasSubstr("unknown"));
  }
  for (const char* name : {"mammogram", "shell", "solid"}) {
    EXPECT_EQ(run_crease({name}).code, 2);
  }
}

}  // namespace
}  // namespace crease
