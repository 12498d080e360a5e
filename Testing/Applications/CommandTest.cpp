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

}  // namespace
}  // namespace crease
