#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "Core/Error.h"
#include "Registration/Landmarks.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::filesystem::path file_with(const std::string& name, const std::string& text) {
  auto path = std::filesystem::path(::testing::TempDir()) / name;
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

TEST(Landmarks, ReadsColumnsInAnyOrderAsSpreadsheetsWriteThem) {
  const auto path = file_with("spreadsheet.csv",
                              "\xEF\xBB\xBFmoving_y, moving_x ,fixed_x,fixed_y\r\n"
                              "# measured twice\r\n"
                              "\r\n"
                              "4,3,1.5,-2e1\r\n"
                              "8,7,5,+6\r\n");
  const auto landmarks = read_landmarks<2>(path);
  ASSERT_EQ(landmarks.size(), 2);
  EXPECT_EQ(landmarks.fixed[0], Point<2>(1.5, -20));
  EXPECT_EQ(landmarks.moving[0], Point<2>(3, 4));
  EXPECT_EQ(landmarks.fixed[1], Point<2>(5, 6));
  EXPECT_EQ(landmarks.moving[1], Point<2>(7, 8));
  EXPECT_TRUE(landmarks.sigma_mm.empty());
}

TEST(Landmarks, TakesSemicolonsForCommas) {
  const auto path = file_with("semicolon.csv", "fixed_x;fixed_y;moving_x;moving_y\n1;2;3;4\n");
  EXPECT_EQ(read_landmarks<2>(path).moving[0], Point<2>(3, 4));
}

TEST(Landmarks, EmptySigmaMeansExact) {
  const auto path =
      file_with("sigma.csv", "fixed_x,fixed_y,moving_x,moving_y,sigma_mm\n1,2,3,4,0.5\n5,6,7,8,\n");
  const auto landmarks = read_landmarks<2>(path);
  EXPECT_EQ(landmarks.sigma_mm[0], 0.5);
  EXPECT_TRUE(std::isnan(landmarks.sigma_mm[1]));
}

TEST(Landmarks, WrittenFileReadsBackToTheLastBit) {
  Landmarks<3> landmarks;
  landmarks.fixed = {{1.0 / 3, -1e-17, 12345.678}, {0.1, 0.2, 0.3}};
  landmarks.moving = {{2.0 / 7, 1e200, -0.0}, {4, 5, 6}};
  landmarks.sigma_mm = {0.1, std::numeric_limits<double>::quiet_NaN()};
  landmarks.names = {"tip", "base, left"};
  const auto path = std::filesystem::path(::testing::TempDir()) / "roundtrip.csv";
  write_landmarks(path, landmarks);
  const auto read = read_landmarks<3>(path);
  EXPECT_EQ(read.fixed, landmarks.fixed);
  EXPECT_EQ(read.moving, landmarks.moving);
  EXPECT_EQ(read.sigma_mm[0], 0.1);
  EXPECT_TRUE(std::isnan(read.sigma_mm[1]));
  EXPECT_EQ(read.names, landmarks.names);
}

TEST(Landmarks, AnglesOfOrientedLandmarksSurvive) {
  Landmarks<2> landmarks;
  landmarks.fixed = {{1, 2}, {3, 4}};
  landmarks.moving = {{1, 2}, {3, 5}};
  landmarks.fixed_angle = {0.25, std::numeric_limits<double>::quiet_NaN()};
  landmarks.moving_angle = {-1.5, std::numeric_limits<double>::quiet_NaN()};
  const auto path = std::filesystem::path(::testing::TempDir()) / "angles.csv";
  write_landmarks(path, landmarks);
  const auto read = read_landmarks<2>(path);
  EXPECT_EQ(read.fixed_angle[0], 0.25);
  EXPECT_EQ(read.moving_angle[0], -1.5);
  EXPECT_TRUE(std::isnan(read.fixed_angle[1]));
}

struct BadFile {
  const char* name;
  const char* text;
  std::vector<std::string> said;
};

class BadLandmarks : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadLandmarks, AreNamedByFileAndPlace) {
  const auto path = file_with(std::string(GetParam().name) + ".csv", GetParam().text);
  for (const std::string& part : GetParam().said) {
    EXPECT_THAT([&] { read_landmarks<2>(path); },
                ThrowsMessage<InvalidInput>(AllOf(HasSubstr(path.string()), HasSubstr(part))));
  }
}

const char* const kHeader = "fixed_x,fixed_y,moving_x,moving_y\n";

INSTANTIATE_TEST_SUITE_P(
    Rows, BadLandmarks,
    ::testing::Values(
        BadFile{"nan",
                "fixed_x,fixed_y,moving_x,moving_y\n1,2,3,4\n112.4,nan,3,4\n",
                {"row 3", "fixed_y", "nan"}},
        BadFile{
            "infinite", "fixed_x,fixed_y,moving_x,moving_y\n1,2,inf,4\n", {"row 2", "moving_x"}},
        BadFile{"word", "fixed_x,fixed_y,moving_x,moving_y\n1,2,3,4mm\n", {"row 2", "4mm"}},
        BadFile{"unpaired", "fixed_x,fixed_y,moving_x,moving_y\n1,2\n", {"row 2", "2 cells", "4"}},
        BadFile{"hole", "fixed_x,fixed_y,moving_x,moving_y\n1,,3,4\n", {"row 2", "fixed_y"}},
        BadFile{"missing", "fixed_x,fixed_y,moving_x\n1,2,3\n", {"moving_y"}},
        BadFile{"misspelt", "fixed_x,fixed_y,moving_x,moving_y,sigma\n1,2,3,4,5\n", {"sigma"}},
        BadFile{"volume",
                "fixed_x,fixed_y,fixed_z,moving_x,moving_y,moving_z\n1,2,3,4,5,6\n",
                {"3D", "fixed_z"}},
        BadFile{"sigma",
                "fixed_x,fixed_y,moving_x,moving_y,sigma_mm\n1,2,3,4,0\n",
                {"row 2", "sigma_mm"}},
        BadFile{"one_angle",
                "fixed_x,fixed_y,moving_x,moving_y,fixed_angle\n1,2,3,4,0\n",
                {"moving_angle"}},
        BadFile{"half_angle",
                "fixed_x,fixed_y,moving_x,moving_y,fixed_angle,moving_angle\n1,2,3,4,0,\n",
                {"row 2", "both"}},
        BadFile{"only_header", kHeader, {"no landmarks"}}, BadFile{"empty", "", {"empty"}}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(Landmarks, MissingFileIsAFileError) {
  EXPECT_THAT([] { read_landmarks<2>("no/such/landmarks.csv"); },
              ThrowsMessage<FileError>(HasSubstr("no/such/landmarks.csv")));
}

std::string markups(const std::string& frame, const std::string& points) {
  return R"({"markups": [{"type": "Fiducial", "coordinateSystem": ")" + frame +
         R"(", "controlPoints": [)" + points + "]}]}";
}

std::string control_point(const std::string& label, const std::string& position) {
  return R"({"label": ")" + label + R"(", "position": )" + position + "}";
}

TEST(SlicerLandmarks, AreTurnedFromRasAndPairedByName) {
  const auto fixed = file_with(
      "fixed.mrk.json",
      markups("RAS", control_point("a", "[1, 2, 3]") + "," + control_point("b", "[4, 5, 6]")));
  const auto moving =
      file_with("moving.mrk.json", markups("LPS", control_point("b", "[40, 50, 60]") + "," +
                                                      control_point("a", "[10, 20, 30]")));
  const auto landmarks = read_slicer_landmarks<3>(fixed, moving);
  EXPECT_EQ(landmarks.names, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(landmarks.fixed[0], Point<3>(-1, -2, 3));
  EXPECT_EQ(landmarks.moving[0], Point<3>(10, 20, 30));
  EXPECT_EQ(landmarks.moving[1], Point<3>(40, 50, 60));
}

TEST(SlicerLandmarks, OldListsArePairedByOrderWhenNamesDiffer) {
  const std::string head = "# Markups fiducial file version = 4.11\n";
  const auto fixed = file_with("fixed.fcsv", head +
                                                 "# CoordinateSystem = 0\n"
                                                 "id1,1,2,3,0,0,0,1,1,1,0,F-1,,\n"
                                                 "id2,4,5,6,0,0,0,1,1,1,0,F-2,,\n");
  const auto moving = file_with("moving.fcsv", head +
                                                   "# CoordinateSystem = LPS\r\n"
                                                   "id1,7,8,9,0,0,0,1,1,1,0,M-1,,\r\n"
                                                   "id2,1,1,1,0,0,0,1,1,1,0,M-2,,\r\n");
  const auto landmarks = read_slicer_landmarks<2>(fixed, moving);
  ASSERT_EQ(landmarks.size(), 2);
  EXPECT_EQ(landmarks.fixed[0], Point<2>(-1, -2));
  EXPECT_EQ(landmarks.moving[0], Point<2>(7, 8));
}

TEST(SlicerLandmarks, UnequalNumbersNameBothFiles) {
  const auto fixed = file_with(
      "two.mrk.json",
      markups("LPS", control_point("a", "[1, 2, 3]") + "," + control_point("b", "[1, 2, 4]")));
  const auto moving = file_with("one.mrk.json", markups("LPS", control_point("a", "[1, 2, 3]")));
  EXPECT_THAT([&] { read_slicer_landmarks<3>(fixed, moving); },
              ThrowsMessage<InvalidInput>(
                  AllOf(HasSubstr("two.mrk.json holds 2"), HasSubstr("one.mrk.json holds 1"))));
}

TEST(SlicerLandmarks, MalformedPositionsAreNamed) {
  const auto good = file_with("good.mrk.json", markups("LPS", control_point("a", "[1, 2, 3]")));
  const auto bad = file_with("bad.mrk.json", markups("LPS", control_point("a", "[1, \"x\", 3]")));
  EXPECT_THAT(
      [&] { read_slicer_landmarks<3>(good, bad); },
      ThrowsMessage<InvalidInput>(AllOf(HasSubstr("bad.mrk.json"), HasSubstr("control point 1"))));
  const auto no_json = file_with("no.mrk.json", "fixed_x,fixed_y");
  EXPECT_THAT([&] { read_slicer_landmarks<3>(good, no_json); },
              ThrowsMessage<InvalidInput>(HasSubstr("no.mrk.json")));
}

}  // namespace
}  // namespace crease
