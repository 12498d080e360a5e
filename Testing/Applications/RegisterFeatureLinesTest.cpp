// What becomes of feature lines that cannot be used as they are: refused, mended with a note, or warned of.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "Testing/Applications/RegisterFixture.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class RegisterFeatureLines : public testing::RegisterFixture {
 protected:
  /// The option, with a file of these rows below the header.
  std::vector<std::string> lines(const std::string& rows,
                                 const std::string& header = "line,x,y\n") const {
    return {"--feature-lines", folder.write("lines.csv", header + rows), "--levels", "1"};
  }
};

TEST_F(RegisterFeatureLines, LinesThatAreNone) {
  expect_refused(run(lines("1,10,10\n")), 3, {"lines.csv, row 2", "a single point"});
  expect_refused(run(lines("1,10,10\n1,nan,20\n")), 3, {"lines.csv, row 3", "column 'x'", "nan"});
  expect_refused(run(lines("1,10,10\n1,,20\n")), 3, {"lines.csv, row 3", "column 'x'"});
  expect_refused(run({"--feature-lines", (folder / "none.csv").string()}), 3, {"none.csv"});
  expect_refused(run(lines("rib,20,20\nrib,24,20\nrib,20,20\n")), 3,
                 {"lines.csv, row 2", "rib", "fewer than three edges"});
  expect_refused(run(lines("1,10,10,bend\n1,20,20,bend\n", "line,x,y,kind\n")), 3,
                 {"lines.csv, row 2", "column 'kind'", "bend", "crease"});
}

TEST_F(RegisterFeatureLines, LinesOutsideTheRegion) {
  expect_refused(run(lines("rib,200,200\nrib,300,200\n")), 3,
                 {"rib", "wholly outside", "(200, 200)"});
  const auto clipped = registered(lines("rib,32,32\nrib,95,32\n"));
  EXPECT_THAT(clipped["warnings"].dump(),
              AllOf(HasSubstr("rib"), HasSubstr("50 %"), HasSubstr("cut off")));
}

TEST_F(RegisterFeatureLines, KindsOfLaterVersions) {
  for (const std::string kind : {"slide", "slit"}) {
    expect_refused(run(lines("1,10,10," + kind + "\n1,50,50," + kind + "\n", "line,x,y,kind\n")), 3,
                   {kind + " lines are not available", "use crease"});
  }
}

TEST_F(RegisterFeatureLines, CrossingsGetAVertexAndANote) {
  const auto two = registered(lines("1,10,35.6\n1,54,35.6\n2,28.5,10\n2,28.5,54\n"));
  EXPECT_THAT(two["notes"].dump(), AllOf(HasSubstr("1 crossing(s)"), HasSubstr("junction")));
  const auto itself = registered(lines("1,15,15\n1,48,48\n1,48,15\n1,15,48\n"));
  EXPECT_THAT(itself["notes"].dump(), HasSubstr("1 crossing(s)"));
}

TEST_F(RegisterFeatureLines, PointsThatAreTooNearAreMerged) {
  // Edges near lines are 4 mm long: a quarter is 1 mm. One point is repeated, one is 0.3 mm off the line.
  const auto result =
      registered(lines("rib,10,20\nrib,10,20\nrib,25,20\nrib,25.4,20.3\nrib,54,20\n"));
  EXPECT_THAT(result["notes"].dump(),
              AllOf(HasSubstr("rib"), HasSubstr("merged"), HasSubstr("moved by at most")));
}

TEST_F(RegisterFeatureLines, PixelStairsAreWarnedOf) {
  std::string rows;
  for (int i = 0; i < 15; ++i) {
    rows += message("stairs,", 15 + i, ",", 15 + i, "\nstairs,", 16 + i, ",", 15 + i, "\n");
  }
  EXPECT_THAT(registered(lines(rows))["warnings"].dump(),
              AllOf(HasSubstr("stairs looks like pixel stairs"), HasSubstr("smooth it first")));
}

TEST_F(RegisterFeatureLines, ClosedLineThatIsTooSmallForItsEdges) {
  expect_refused(run(lines("dot,30,30\ndot,30.4,30\ndot,30.2,30.3\ndot,30,30\n")), 3,
                 {"feature line dot", "shorter than three edges", "shorter edges"});
}

TEST_F(RegisterFeatureLines, BodySideOfALineThatEndsInsideIsAllowed) {
  const auto result =
      registered(lines("1,20,20,left\n1,32,24,left\n1,44,20,left\n", "line,x,y,body\n"));
  EXPECT_TRUE(result["warnings"].empty()) << result["warnings"];
}

// Above 5 % of the domain the bands in which creases bend are too wide for the outline's curvature.
TEST_F(RegisterFeatureLines, OutlineTooCoarseForItsCurvatureIsWarnedOf) {
  std::string rows;
  for (int k = 0; k <= 5; ++k) {
    const double angle = 2 * std::numbers::pi * k / 5;
    rows += message("disc,", 32 + 28 * std::cos(angle), ",", 32 + 28 * std::sin(angle), ",none\n");
  }
  auto extra = lines(rows, "line,x,y,body\n");
  extra.insert(extra.end(), {"--mesh-size", "60"});
  EXPECT_THAT(registered(extra)["warnings"].dump(), HasSubstr("band"));
}

TEST_F(RegisterFeatureLines, MeshThatWouldBeTooFine) {
  expect_refused(run({"--mesh-size", "0.01"}), 3, {"0.01 mm", "at most 2000000", "longer edges"});
  expect_refused(run({"--transform", "bspline", "--mesh-size", "0.01"}), 3,
                 {"0.01 mm", "at most 2e+06", "larger spans"});
}

}  // namespace
}  // namespace crease
