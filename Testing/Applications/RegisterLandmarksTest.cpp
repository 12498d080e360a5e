// Landmarks that cannot be met: what is refused, and what the policies for contradictions do.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "Testing/Applications/RegisterFixture.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class RegisterLandmarks : public testing::RegisterFixture {
 protected:
  static constexpr const char* kHeader = "fixed_x,fixed_y,moving_x,moving_y\n";

  std::vector<std::string> landmarks(const std::string& text,
                                     const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"--landmarks", folder.write("pairs.csv", text)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  /// Pairs at random places of a square in the middle, each moved at random by up to `shift` mm.
  static std::string random_pairs(int count, double width, double shift) {
    std::ostringstream text;
    text << kHeader;
    unsigned state = 7;
    const auto random = [&] { return (state = state * 1664525u + 1013904223u) / 4294967296.0; };
    for (int i = 0; i < count; ++i) {
      const double x = 32 + width * (random() - 0.5), y = 32 + width * (random() - 0.5);
      text << x << ',' << y << ',' << x + shift * random() << ',' << y + shift * random() << '\n';
    }
    return text.str();
  }
};

TEST_F(RegisterLandmarks, RowsThatAreMalformed) {
  const std::string header = kHeader;
  expect_refused(run(landmarks(header + "10,10,11,11\n12,x,13,13\n")), 3,
                 {"pairs.csv, row 3", "'fixed_y'", "'x'"});
  expect_refused(run(landmarks(header + "10,10,11\n")), 3, {"pairs.csv", "2"});
  expect_refused(run(landmarks(header + "10,10,11,inf\n")), 3, {"pairs.csv, row 2", "moving_y"});
  expect_refused(run(landmarks("fixed_x,fixed_y\n10,10\n")), 3, {"pairs.csv", "moving_x"});
  expect_refused(
      run(landmarks("fixed_x,fixed_y,fixed_z,moving_x,moving_y,moving_z\n1,1,1,1,1,1\n")), 3,
      {"pairs.csv", "fixed_z"});
  expect_refused(run({"--landmarks", (folder / "none.csv").string()}), 3, {"none.csv"});
}

TEST_F(RegisterLandmarks, UnpairedPointsOfSlicer) {
  const std::string header = "# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n";
  const std::string two = folder.write(
      "two.fcsv", header + "1,10,10,0,0,0,0,1,1,1,0,a,,\n2,20,20,0,0,0,0,1,1,1,0,b,,\n");
  const std::string one = folder.write("one.fcsv", header + "1,11,10,0,0,0,0,1,1,1,0,a,,\n");
  expect_refused(run({"--landmarks", two, "--landmarks", one}), 3,
                 {"two.fcsv holds 2", "one.fcsv holds 1"});
  expect_refused(run({"--landmarks", two, "--landmarks", one, "--landmarks", one}), 2,
                 {"--landmarks takes one CSV file, or two files"});
}

TEST_F(RegisterLandmarks, OutsideTheDomain) {
  const std::string header = kHeader;
  expect_refused(run(landmarks(header + "10,10,10,10\n-20,30,11,11\n")), 3,
                 {"landmark 2", "(-20, 30) mm", "19.5 mm outside the domain"});
  expect_refused(
      run(landmarks(header + "10,10,10,10\n-20,30,11,11\n", {"--landmarks-mode", "soft"})), 3,
      {"landmark 2", "19.5 mm outside the domain"});
  const std::string roi = folder.write("roi.csv", "ring,x,y\n0,5,5\n0,40,5\n0,40,60\n0,5,60\n");
  expect_refused(run(landmarks(header + "50,30,50,30\n", {"--roi", roi})), 3,
                 {"landmark 1", "10 mm outside", "region of interest"});
}

TEST_F(RegisterLandmarks, OnePointForTwoPlaces) {
  const std::string text = std::string(kHeader) + "9,9,9,9\n20,30,21,31\n20,30,24,35\n";
  for (const char* policy : {"error", "refine", "compromise"}) {
    expect_refused(run(landmarks(text, {"--landmarks-conflict", policy})), 3,
                   {"landmarks 2 and 3", "(20, 30) mm", "5 mm apart", "delete one"});
  }
}

TEST_F(RegisterLandmarks, RepeatedLandmarkIsIgnoredWithANote) {
  const auto result =
      registered(landmarks(std::string(kHeader) + "9,9,9,9\n20,30,21,31\n20,30,21,31\n"));
  EXPECT_THAT(result["warnings"].dump(), HasSubstr("landmark 3 follows from landmark 2; ignored"));
  EXPECT_LT(result["landmarks"]["max_error_mm"], 64e-9);
}

// Sixty pairs within a few triangles: more than cubic patches can meet.
TEST_F(RegisterLandmarks, ContradictionsAreAnErrorUnlessToldOtherwise) {
  expect_refused(run(landmarks(random_pairs(60, 12, 1))), 3,
                 {"contradict each other: landmark", "in triangle", " mm;", "sigma",
                  "--landmarks-conflict refine", "--landmarks-conflict compromise"});
}

// Thirty can only just be met: the user learns why the map folds, or why there is none.
TEST_F(RegisterLandmarks, NearContradictionsAreWarnedOf) {
  for (const int count : {20, 30}) {
    const auto finished = run(landmarks(random_pairs(count, 12, 1)));
    EXPECT_EQ(finished.code, count == 20 ? 0 : 5);
    EXPECT_THAT(testing::read_result(output())["warnings"].dump(),
                AllOf(HasSubstr("nearly contradict each other"), HasSubstr("times as far"),
                      HasSubstr("--landmarks-conflict refine")));
  }
  const auto refined =
      registered(landmarks(random_pairs(30, 12, 1), {"--landmarks-conflict", "refine"}));
  EXPECT_LT(refined["landmarks"]["max_error_mm"], 64e-9);
  EXPECT_LT(refined["jacobian"]["folded_fraction"], 0.01);
}

TEST_F(RegisterLandmarks, ContradictionsAreRefined) {
  const auto coarse = registered(landmarks(random_pairs(5, 12, 1)));
  const auto fine =
      registered(landmarks(random_pairs(60, 12, 1), {"--landmarks-conflict", "refine"}));
  EXPECT_LT(fine["landmarks"]["max_error_mm"], 64e-9);
  EXPECT_GT(fine["triangles"], coarse["triangles"]);
  EXPECT_THAT(fine["warnings"].dump(),
              AllOf(HasSubstr("60 exact landmarks"), HasSubstr("divided"), HasSubstr("became")));
}

TEST_F(RegisterLandmarks, ContradictionsAreMetOnAverage) {
  const auto result =
      registered(landmarks(random_pairs(60, 12, 1), {"--landmarks-conflict", "compromise"}));
  EXPECT_EQ(result["status"], "ok");
  EXPECT_GT(result["landmarks"]["rms_error_mm"], 0.01);
  EXPECT_LT(result["landmarks"]["rms_error_mm"], 0.6);  // that of the shifts alone, about 0.8 mm
  EXPECT_EQ(result["landmarks"]["errors_mm"].size(), 60);
  EXPECT_THAT(result["warnings"].dump(), HasSubstr("met in the least-squares sense"));
}

// Landmarks that nearly repeat each other make the constraints nearly singular.
TEST_F(RegisterLandmarks, VeryDenseContradictionsAreMetOnAverage) {
  for (const double width : {4.0, 1.0, 0.1}) {
    const auto result =
        registered(landmarks(random_pairs(100, width, 1), {"--landmarks-conflict", "compromise"}));
    EXPECT_EQ(result["status"], "ok");
    EXPECT_LT(result["landmarks"]["rms_error_mm"], 0.6) << width;
  }
}

TEST_F(RegisterLandmarks, PoliciesForContradictionsNeedExactLandmarksAndTriangles) {
  const std::string text = std::string(kHeader) + "9,9,9,9\n";
  expect_refused(run({"--landmarks-conflict", "refine"}), 2,
                 {"--landmarks-conflict needs --landmarks"});
  expect_refused(
      run(landmarks(text, {"--landmarks-conflict", "refine", "--landmarks-mode", "soft"})), 2,
      {"--landmarks-conflict", "exact"});
  expect_refused(run(landmarks(text, {"--landmarks-conflict", "refine", "--transform", "bspline"})),
                 2, {"--landmarks-conflict refine", "triangular-bspline"});
  expect_refused(run(landmarks(text, {"--landmarks-conflict", "refien"})), 2,
                 {"did you mean refine?"});
}

}  // namespace
}  // namespace crease
