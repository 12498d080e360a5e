#include "Applications/ProgressReporter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

namespace crease {
namespace {

using ::testing::HasSubstr;

const RegistrationProgress kStart = {"alignment", 0, 3, 0, 0, 0};
const RegistrationProgress kLevel = {"level", 2, 3, 4, 12.5, 0.5};

std::string told(ProgressReporter::Style style) {
  std::ostringstream stream;
  {
    ProgressReporter reporter(style, stream, "register");
    EXPECT_TRUE(reporter.callback()(kStart));
    EXPECT_TRUE(reporter.callback()(kLevel));
    reporter.warn("folds");
  }
  return stream.str();
}

TEST(ProgressReporter, QuietTellsNothing) {
  EXPECT_EQ(told(ProgressReporter::Style::kNothing), "");
}

TEST(ProgressReporter, LinesTellStageLevelIterationAndEnergy) {
  const std::string text = told(ProgressReporter::Style::kLines);
  EXPECT_THAT(text, HasSubstr("alignment"));
  EXPECT_THAT(text, HasSubstr("50 %  level 2/3, iteration 4, energy 12.5"));
  EXPECT_THAT(text, HasSubstr("crease register: warning: folds\n"));
  EXPECT_EQ(std::ranges::count(text, '\n'), 3);
}

TEST(ProgressReporter, JsonIsOneObjectPerLine) {
  std::istringstream lines(told(ProgressReporter::Style::kJson));
  std::vector<nlohmann::json> objects;
  for (std::string line; std::getline(lines, line);) objects.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(objects.size(), 3u);
  EXPECT_EQ(objects[1]["stage"], "level");
  EXPECT_EQ(objects[1]["level"], 2);
  EXPECT_EQ(objects[1]["levels"], 3);
  EXPECT_EQ(objects[1]["iteration"], 4);
  EXPECT_EQ(objects[1]["energy"], 12.5);
  EXPECT_EQ(objects[1]["fraction"], 0.5);
  EXPECT_GE(objects[1]["remaining_s"], 0.0);
  EXPECT_EQ(objects[2]["warning"], "folds");
}

TEST(ProgressReporter, BarIsRedrawnAndClearedAtTheEnd) {
  const std::string text = told(ProgressReporter::Style::kBar);
  EXPECT_THAT(text,
              HasSubstr("[############............]  50 %  level 2/3, iteration 4, energy 12.5"));
  EXPECT_THAT(text, HasSubstr("s left"));
  EXPECT_THAT(text, HasSubstr("\r\033[Kcrease register: warning: folds\n"));
}

}  // namespace
}  // namespace crease
