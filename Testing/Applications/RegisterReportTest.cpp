// What report.html of a run tells; ReportPageTest.cpp looks at it in a browser.
#include "Applications/Report/HtmlReport.h"
#include "Testing/Applications/RegisterFixture.h"

namespace crease {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

class RegisterReport : public testing::RegisterFixture {
 protected:
  std::string page() const { return testing::read_text(folder / "out/report.html"); }
};

TEST_F(RegisterReport, TellsTheVerdictAndWhereItComesFrom) {
  const auto result = registered({});
  const std::string text = page();
  EXPECT_THAT(text, HasSubstr("moving.mha registered to fixed.mha"));
  EXPECT_THAT(text, ContainsRegex("badge good.*finished"));
  EXPECT_THAT(text, ContainsRegex("The match improved: ssd [0-9.]+ .* [0-9.]+, correlation"));
  EXPECT_THAT(text, HasSubstr("No folds at 4\u202f096 samples"));
  EXPECT_THAT(text, HasSubstr("Invertible: certified everywhere"));
  for (const auto& input : result["inputs"]) {
    EXPECT_THAT(text, HasSubstr(input["sha256"].get<std::string>()));
  }
  EXPECT_THAT(text, HasSubstr(escape_html(testing::read_text(folder / "out/config.toml"))));
  EXPECT_THAT(text, HasSubstr("No landmarks were given."));
  EXPECT_THAT(text, Not(HasSubstr("class=\"warnings\"")));
}

TEST_F(RegisterReport, TellsWarningsFoldsAndResiduals) {
  // Two landmarks that change sides: the map between must fold.
  const std::string landmarks = folder.write(
      "landmarks.csv", "fixed_x,fixed_y,moving_x,moving_y\n28,32,36,32\n36,32,28,32\n");
  const auto finished = run(
      {"--landmarks", landmarks, "--metric", "none", "--transform", "bspline", "--mesh-size", "6"});
  ASSERT_EQ(finished.code, 0) << finished.err;
  const std::string text = page();
  EXPECT_THAT(text, ContainsRegex("badge caution.*finished"));
  EXPECT_THAT(text, HasSubstr("The map folds at"));
  EXPECT_THAT(text, HasSubstr("Invertible: not certified"));
  EXPECT_THAT(text, HasSubstr("class=\"warnings\""));
  EXPECT_THAT(text, HasSubstr("2 landmark pairs are met exactly"));
  EXPECT_THAT(text, HasSubstr("<td class=\"number\">8.000</td>"));  // apart before
}

TEST_F(RegisterReport, LeavesDifferencesOutWhereIntensitiesMeanDifferentThings) {
  registered({"--metric", "mi", "--levels", "1"});
  const std::string text = page();
  EXPECT_THAT(text, HasSubstr("their difference would say nothing"));
  EXPECT_THAT(text, Not(HasSubstr("warped \u2212 fixed")));
}

}  // namespace
}  // namespace crease
