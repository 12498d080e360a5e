#include "Registration/PointFile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "Core/Error.h"
#include "Testing/TemporaryFolder.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::read_text;
using ::testing::ThrowsMessage;

class PointFiles : public ::testing::Test {
 protected:
  /// Reads a file and writes it with all points moved by (1, 2, 4), as "out" with the same ending.
  std::string moved(const std::string& name, const std::string& text) {
    const std::string in = folder_.write(name, text);
    const auto file = read_point_file(in);
    std::vector<Point<3>> points = file->points();
    for (auto& p : points) p += Point<3>(1, 2, 4);
    const auto out = folder_ / ("out" + name.substr(name.find('.')));
    write_point_file(out, *file, in, points);
    return read_text(out);
  }
  std::unique_ptr<PointFile> read(const std::string& name, const std::string& text) const {
    return read_point_file(folder_.write(name, text));
  }
  void expect_refused(const std::string& name, const std::string& text, const char* reason) const {
    const std::string file = folder_.write(name, text);
    EXPECT_THAT([&] { read_point_file(file); },
                ThrowsMessage<InvalidInput>(AllOf(HasSubstr(name), HasSubstr(reason))));
  }
  testing::TemporaryFolder folder_;
};

/// As VTK writes numbers: the high byte first.
template <typename Number>
std::string big_endian(std::initializer_list<Number> numbers) {
  std::string text;
  for (const Number number : numbers) {
    std::string bytes(sizeof(Number), '\0');
    std::memcpy(bytes.data(), &number, sizeof(Number));
    text.append(bytes.rbegin(), bytes.rend());
  }
  return text;
}

}  // namespace

TEST_F(PointFiles, TablesKeepTheirNamesAndDimension) {
  EXPECT_EQ(moved("a.csv", "x,y,name\n1,2.5,left\n"), "x,y,name\n2,4.5,left\n");
  EXPECT_EQ(moved("a.csv", "y,x,z\n2.5,1,0\n"), "x,y,z\n2,4.5,4\n");
  EXPECT_EQ(read("a.csv", "x,y\n1,2\n")->dimension(), 2);
}

TEST_F(PointFiles, OldSlicerListsKeepEverythingElse) {
  const std::string head = "# Markups fiducial file version = 4.10\n";
  const std::string row = ",0,0,0,1,1,1,0,F-1,a note,vtkMRMLScalarVolumeNode1\n";
  const auto file = read("a.fcsv", head + "# CoordinateSystem = 0\nid_0,1,2,3" + row);
  EXPECT_EQ(file->points()[0], Point<3>(-1, -2, 3));
  EXPECT_EQ(file->names()[0], "F-1");
  EXPECT_EQ(moved("a.fcsv", head + "# CoordinateSystem = RAS\nid_0,1,2.5,3" + row),
            head + "# CoordinateSystem = RAS\nid_0,0,0.5,7" + row);
  EXPECT_EQ(moved("a.fcsv", head + "# CoordinateSystem = LPS\nid_0,1,2.5,3" + row),
            head + "# CoordinateSystem = LPS\nid_0,2,4.5,7" + row);
  EXPECT_EQ(moved("a.fcsv", "id_0,1,2,3\n"), "id_0,0,0,7\n");  // RAS, if nothing is said
}

TEST_F(PointFiles, MarkupsKeepEverythingElse) {
  const std::string text = R"({"@schema": "markups-schema-v1.0.3.json#", "markups": [
    {"type": "Curve", "coordinateSystem": "RAS", "measurements": [{"name": "length", "value": 3.5}],
     "controlPoints": [{"id": "1", "label": "a", "position": [1, 2, 3], "locked": true}]},
    {"type": "Fiducial", "coordinateSystem": "LPS",
     "controlPoints": [{"label": "b", "position": [0, 0, 0], "positionStatus": "undefined"},
                       {"label": "c", "position": [7, 8, 9.5], "positionStatus": "defined"}]}]})";
  auto expected = nlohmann::json::parse(text);
  expected["markups"][0]["controlPoints"][0]["position"] = {0, 0, 7};
  expected["markups"][1]["controlPoints"][1]["position"] = {8, 10, 13.5};
  const std::string out = moved("a.mrk.json", text);
  EXPECT_EQ(nlohmann::json::parse(out), expected);
  EXPECT_LT(out.find("@schema"), out.find("markups\""));  // and their order
  const auto file = read("a.mrk.json", text);
  EXPECT_EQ(file->names(), (std::vector<std::string>{"a", "c"}));
  const auto lost = nlohmann::json::parse(
      file->with_points({Point<3>(0, 0, 0), Point<3>::Constant(std::nan(""))}));
  EXPECT_EQ(lost["markups"][1]["controlPoints"][1]["positionStatus"], "undefined");
}

TEST_F(PointFiles, VtkTextKeepsEverythingElse) {
  const std::string head =
      "# vtk DataFile Version 3.0\nPOINTS 7 of interest\nASCII\nDATASET POLYDATA\n";
  const std::string rest =
      "\n\nPOLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nSCALARS s float\nLOOKUP_TABLE default\n1 2 3\n";
  EXPECT_EQ(moved("a.vtk", head + "POINTS 3 float\n0 0 0  1 0.5 0\n0 1\n1e1" + rest),
            head + "POINTS 3 double\n1 2 4\n2 2.5 4\n1 3 14" + rest);
  const std::string field = "FIELD FieldData 1\nTIME 1 2 double\n0.5 1.5\n";
  EXPECT_EQ(moved("a.vtk", head + field + "POINTS 1 double\n0 0 0\n"),
            head + field + "POINTS 1 double\n1 2 4\n");
}

TEST_F(PointFiles, VtkBinaryKeepsEverythingElse) {
  const std::string head = "# vtk DataFile Version 4.2\na mesh\nBINARY\nDATASET POLYDATA\n";
  const std::string rest = "\nVERTICES 2 4\n" + big_endian<std::int32_t>({1, 0, 1, 1}) +
                           "\nPOINT_DATA 2\nSCALARS s double\nLOOKUP_TABLE default\n" +
                           big_endian<double>({0.1, 1e300}) + "\n";
  const std::string field =
      "FIELD FieldData 1\nTIME 1 1 float\n" + big_endian<float>({2.5f}) + "\n";
  EXPECT_EQ(moved("a.vtk", head + field + "POINTS 2 float\n" +
                               big_endian<float>({0, 0, 0, 1, 0.5f, -8}) + rest),
            head + field + "POINTS 2 double\n" + big_endian<double>({1, 2, 4, 2, 2.5, -4}) + rest);
}

TEST_F(PointFiles, VtkOfSlicerMayBeRas) {
  const std::string head = "# vtk DataFile Version 5.1\n3D Slicer output. SPACE=RAS\nASCII\n";
  const std::string text = head + "DATASET UNSTRUCTURED_GRID\nPOINTS 1 double\n1 2 3\n";
  EXPECT_EQ(read("a.vtk", text)->points()[0], Point<3>(-1, -2, 3));
  EXPECT_THAT(moved("a.vtk", text), HasSubstr("double\n0 0 7\n"));
}

TEST_F(PointFiles, SayWhatIsWrong) {
  const std::string vtk = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n";
  expect_refused("a.vtk", "<VTKFile>\n", "does not begin with \"# vtk DataFile\"");
  expect_refused("a.vtk", "# vtk DataFile Version 3.0\nt\nascii\n", "neither ASCII nor BINARY");
  expect_refused("a.vtk", vtk, "ends within its header");
  expect_refused("a.vtk", vtk + "POLYGONS 1 4\n3 0 1 2\n", "has no POINTS before \"POLYGONS\"");
  expect_refused("a.vtk", vtk + "POINTS 2 float\n0 0 0 1 1\n", "it may be cut off");
  expect_refused("a.vtk", vtk + "POINTS 1 float\n0 nan 0\n", "is not finite");
  expect_refused("a.vtk", vtk + "POINTS -1 float\n", "\"-1\" where a count should be");
  expect_refused("a.vtk", vtk + "POINTS 0 float\n", "holds no point");
  expect_refused("a.vtk", vtk + "POINTS 1 quad\n1 2 3\n", "the type \"quad\"");
  expect_refused("a.vtk",
                 "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\nPOINTS 2 float\nabcd",
                 "is cut off");
  expect_refused("a.mrk.json", "{\"markups\": []}", "holds no markup");
  expect_refused("a.mrk.json", "{\"markups\": [{\"type\": \"Fiducial\", \"controlPoints\": []}]}",
                 "holds no placed point");
  expect_refused("a.fcsv", "# nothing\n", "holds no placed point");
  expect_refused("a.xyz", "1 2 3\n", "known are .csv, .fcsv, .mrk.json and .vtk");
  EXPECT_THROW(read_point_file(folder_ / "none.vtk"), Error);
  const auto file = read("a.csv", "x,y\n1,2\n");
  EXPECT_THAT(
      [&] { write_point_file(folder_ / "b.fcsv", *file, folder_ / "a.csv", file->points()); },
      ThrowsMessage<InvalidInput>(HasSubstr("name a file that ends in .csv")));
}

}  // namespace crease
