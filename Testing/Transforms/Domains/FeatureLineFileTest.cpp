#include "Transforms/Domains/FeatureLineFile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "Core/Error.h"
#include "Testing/Transforms/Domains/SampleDomains.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::string write_file(const std::string& name, const std::string& text) {
  const auto path = std::filesystem::temp_directory_path() / ("crease_lines_" + name);
  std::ofstream(path) << text;
  return path.string();
}

}  // namespace

TEST(FeatureLineFile, ReadsOpenAndClosedLines) {
  const auto lines = read_feature_lines(
      write_file("two.csv",
                 "\xEF\xBB\xBFline, x, y\r\n# a comment\r\nA,0,0\r\nA,1,0\r\nA,1,1\r\nA,0,0\r\n\r\n"
                 "\"B, second\",+5,5\r\n\"B, second\",6e0,5.5\r\n"));
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_TRUE(lines[0].closed);
  EXPECT_EQ(lines[0].points.size(), 3U);
  EXPECT_EQ(body_side(lines[0]), BodySide::kLeft);
  EXPECT_FALSE(lines[1].closed);
  EXPECT_EQ(lines[1].name, "B, second");
  EXPECT_EQ(lines[1].points[1], Point<2>(6, 5.5));
  EXPECT_EQ(lines[1].kind, FeatureKind::kCrease);
}

TEST(FeatureLineFile, ReadsKindBodyAndCorner) {
  const auto lines = read_feature_lines(write_file(
      "all.csv",
      "line,x,y,kind,body,corner\n1,0,0,slide,right,collapse\n1,1,0,slit,right,collapse\n"
      "1,2,0,slit,right,collapse\n2,0,1,,,\n2,1,1,,,\n"));
  EXPECT_EQ(lines[0].kind, FeatureKind::kSlide);
  EXPECT_EQ(lines[0].edge_kind(1), FeatureKind::kSlit);
  EXPECT_EQ(lines[0].body, BodySide::kRight);
  EXPECT_EQ(lines[0].corner, CornerRule::kCollapse);
  EXPECT_EQ(lines[1].kind, FeatureKind::kCrease);
  EXPECT_EQ(lines[1].corner, CornerRule::kBlunt);
}

TEST(FeatureLineFile, ErrorsNameFileRowAndColumn) {
  const auto expect = [](const std::string& text, const std::string& a, const std::string& b) {
    const auto path = write_file("bad.csv", text);
    EXPECT_THAT(
        [&] { read_feature_lines(path); },
        ThrowsMessage<InvalidInput>(AllOf(HasSubstr("bad.csv"), HasSubstr(a), HasSubstr(b))));
  };
  expect("line,x,y\n1,0,0\n1,nan,3\n", "row 3", "column 'x'");
  expect("line,x,y\n1,0,0\n1,1,3 mm\n", "row 3", "column 'y'");
  expect("line,x,y\n1,0,0\n", "row 2", "single point");
  expect("line,x,y\n1,0,0\n1,1,1\n1,0,0\n", "row 2", "fewer than three edges");
  expect("line,x,y\n1,0\n", "row 2", "2 cells");
  expect("line,x\n1,0\n", "'y'", "missing");
  expect("line,x,y,colour\n1,0,0,red\n", "'colour'", "unknown");
  expect("line,x,y,kind\n1,0,0,fold\n1,1,0,crease\n", "row 2, column 'kind'", "fold");
  expect("line,x,y,body\n1,0,0,left\n1,1,0,right\n", "row 3", "whole line");
  expect("line,x,y\n", "holds no points", "column names");
  expect("", "is empty", "columns");
  EXPECT_THROW(read_feature_lines("/no/such/file.csv"), FileError);
}

TEST(FeatureLineFile, WritingAndReadingGivesTheSameLines) {
  FeatureLine closed = testing::closed_line(testing::regular_polygon({1.0 / 3, 2}, 0.7, 5));
  FeatureLine open = testing::open_line({{0, 0}, {0.1, 1e-17}, {1e10, 3}}, BodySide::kRight);
  open.corner = CornerRule::kCollapse;
  open.edge_kinds = {FeatureKind::kCrease, FeatureKind::kSlit};
  const auto path = write_file("round.csv", "");
  write_feature_lines(path, {closed, open});
  const auto read = read_feature_lines(path);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].points, closed.points);
  EXPECT_TRUE(read[0].closed);
  EXPECT_EQ(body_side(read[0]), BodySide::kLeft);
  EXPECT_EQ(read[1].points, open.points);
  EXPECT_EQ(read[1].body, BodySide::kRight);
  EXPECT_EQ(read[1].corner, CornerRule::kCollapse);
  EXPECT_EQ(read[1].edge_kind(1), FeatureKind::kSlit);
  EXPECT_THROW(write_feature_lines("/no/such/folder/lines.csv", {open}), FileError);
}

TEST(FeatureLineFile, ReadsSlicerCurvesInBothFrames) {
  const std::string points =
      R"("controlPoints":[{"position":[1,2,0]},{"position":[3,2,0]},{"position":[3,5,0]},)"
      R"({"position":[9,9,9],"positionStatus":"undefined"}])";
  const auto lines = read_feature_lines(write_file(
      "curves.mrk.json", R"({"markups":[{"type":"ClosedCurve","coordinateSystem":"LPS",)" + points +
                             R"(},{"type":"Curve","coordinateSystem":"RAS",)" + points + "}]}"));
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_TRUE(lines[0].closed);
  EXPECT_EQ(lines[0].points.size(), 3U);
  EXPECT_EQ(lines[0].points[1], Point<2>(3, 2));
  EXPECT_FALSE(lines[1].closed);
  EXPECT_EQ(lines[1].points[1], Point<2>(-3, -2));
}

TEST(FeatureLineFile, BadSlicerFilesAreRefusedWithTheirPlace) {
  const auto expect = [](const std::string& text, const std::string& part) {
    const auto path = write_file("bad.mrk.json", text);
    EXPECT_THAT([&] { read_feature_lines(path); },
                ThrowsMessage<InvalidInput>(AllOf(HasSubstr("bad.mrk.json"), HasSubstr(part))));
  };
  expect("{", "not valid JSON");
  expect("{}", "markups");
  expect(R"({"markups":[]})", "no curve");
  expect(R"({"markups":[{"type":"Fiducial"}]})", "markup 1: type 'Fiducial'");
  expect(R"({"markups":[{"type":"Curve","controlPoints":[{"position":[1,2,3]}]}]})", "markup 1");
  expect(R"({"markups":[{"type":"Curve","controlPoints":[{"position":["a"]}]}]})",
         "control point 1");
  expect(R"({"markups":[{"type":"Curve","coordinateSystem":"XYZ","controlPoints":[]}]})",
         "neither LPS nor RAS");
  EXPECT_THROW(read_feature_lines("/no/such/file.mrk.json"), FileError);
}

}  // namespace crease
