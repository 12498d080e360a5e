#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "Geometry/SurfaceMeshFile.h"
#include "Images/ImageFile.h"
#include "Testing/Applications/CommandRunner.h"
#include "Testing/TemporaryFolder.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/SplineTransform.h"
#include "Transforms/Splines/TensorBSplineBasis.h"
#include "Transforms/TransformFile.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using testing::read_text;
using testing::run_crease;

/// A smooth spline, an affine map and an image, on disk.
class WarpCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    Raster<2> raster;
    raster.size = {40, 32};
    raster.spacing = {1, 1.5};
    raster.origin = {-3, 2};
    Image<float, 2> image(raster);
    LabelImage<2> labels(raster);
    for (int j = 0; j < 32; ++j) {
      for (int i = 0; i < 40; ++i) {
        image(i, j) = static_cast<float>(std::sin(0.3 * i) + std::cos(0.2 * j));
        labels(i, j) = (i / 8 + j / 8) % 3;
      }
    }
    write_image(folder / "image.mha", image, PixelType::kFloat);
    write_labels(folder / "labels.mha", labels);

    const auto basis =
        std::make_shared<const TensorBSplineBasis<2>>(covering_lattice(raster, 10.0));
    SplineTransform<2> spline(basis);
    ControlPoints<2> phi(2, basis->num_control_points());
    for (Eigen::Index i = 0; i < phi.cols(); ++i) {
      phi.col(i) << std::sin(1.7 * static_cast<double>(i)), std::cos(2.9 * static_cast<double>(i));
    }
    spline.set_control_points(phi);
    save_transform(spline, folder / "spline.json");
    AffineMap<2> map;
    map.linear << 0, -1, 1, 0;
    map.offset << 30, 4;
    save_transform(AffineTransform<2>(map), folder / "turn.json");
  }
  std::string file(const std::string& name) const { return (folder / name).string(); }
  /// The numbers of a CSV file with a header.
  static std::vector<std::vector<double>> rows(const std::string& text) {
    std::istringstream lines(text);
    std::vector<std::vector<double>> result;
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      std::istringstream cells(line);
      result.emplace_back();
      for (std::string cell; std::getline(cells, cell, ',');)
        result.back().push_back(std::stod(cell));
    }
    return result;
  }
  testing::TemporaryFolder folder;
};

TEST_F(WarpCommand, MapsPointsThroughAChainFirstTransformFirst) {
  const std::string points = folder.write("in.csv", "x,y,name\n10,20,a\n1.5,-2,b\n");
  const auto run =
      run_crease({"warp", "--transform", file("spline.json"), "--transform", file("turn.json"),
                  "--points", points, "--output-points", file("out.csv"), "--quiet"});
  ASSERT_EQ(run.code, 0) << run.err;
  const std::string text = read_text(folder / "out.csv");
  EXPECT_THAT(text, ::testing::StartsWith("x,y,name\n"));
  EXPECT_THAT(text, HasSubstr(",a\n"));
  const auto spline = load_transform<2>(folder / "spline.json");
  const Point<2> y = spline->map({10, 20});
  std::istringstream first(text.substr(text.find('\n') + 1));
  double a = 0, b = 0;
  char comma = 0;
  first >> a >> comma >> b;
  EXPECT_EQ(a, 30 - y.y());  // to the last bit: numbers are written in full
  EXPECT_EQ(b, 4 + y.x());
}

TEST_F(WarpCommand, InverseUndoesIt) {
  const std::string points = folder.write("in.csv", "x,y\n10,20\n1.5,9\n30,41\n");
  const std::vector<std::string> chain = {"--transform", file("spline.json"), "--transform",
                                          file("turn.json")};
  const auto run = [&](const std::string& in, const std::string& out,
                       const std::vector<std::string>& extra) {
    std::vector<std::string> arguments = {"warp", "--points", in, "--output-points",
                                          out,    "--quiet"};
    arguments.insert(arguments.end(), chain.begin(), chain.end());
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    const auto result = run_crease(arguments);
    EXPECT_EQ(result.code, 0) << result.err;
  };
  run(points, file("there.csv"), {});
  run(file("there.csv"), file("back.csv"), {"--inverse"});
  const auto in = rows(read_text(points)), back = rows(read_text(folder / "back.csv"));
  ASSERT_EQ(back.size(), in.size());
  for (std::size_t i = 0; i < in.size(); ++i) {
    EXPECT_NEAR(back[i][0], in[i][0], 1e-6);
    EXPECT_NEAR(back[i][1], in[i][1], 1e-6);
  }
}

TEST_F(WarpCommand, WritesTheDisplacementField) {
  ASSERT_EQ(run_crease({"warp", "--transform", file("spline.json"), "--reference",
                        file("image.mha"), "--displacement", file("u.mha"), "--quiet"})
                .code,
            0);
  const auto field = read_displacement_field<2>(folder / "u.mha");
  const auto spline = load_transform<2>(folder / "spline.json");
  for (const auto& [i, j] : {std::pair{0, 0}, {17, 5}, {39, 31}}) {
    const Point<2> x = field.raster().point(Vector<2>(i, j));
    EXPECT_LT((field(i, j) - (spline->map(x) - x)).norm(), 1e-12);
  }
}

TEST_F(WarpCommand, WarpsImagesAndLabels) {
  ASSERT_EQ(run_crease({"warp", "--transform", file("turn.json"), "--moving", file("labels.mha"),
                        "--reference", file("image.mha"), "--output-image", file("w.mha"),
                        "--interpolator", "nearest", "--outside", "7", "--quiet"})
                .code,
            0);
  const auto warped = read_labels<2>(folder / "w.mha");
  const auto labels = read_labels<2>(folder / "labels.mha");
  EXPECT_EQ(read_image<2>(folder / "w.mha").pixel_type, PixelType::kUint8);  // as the moving image
  int outside = 0;
  for (int j = 0; j < 32; ++j) {
    for (int i = 0; i < 40; ++i) {
      const Point<2> x = warped.raster().point(Vector<2>(i, j));
      const Vector<2> index = labels.raster().index({30 - x.y(), 4 + x.x()});
      const int a = static_cast<int>(std::round(index.x())),
                b = static_cast<int>(std::round(index.y()));
      const bool inside = a >= 0 && a < 40 && b >= 0 && b < 32;
      const Vector<2> beyond = index - Vector<2>(std::floor(index.x()), std::floor(index.y()));
      const bool tie = ((beyond.array() - 0.5).abs() < 1e-6).any();
      if (!inside) ++outside;
      if (tie) continue;
      EXPECT_EQ(warped(i, j), inside ? labels(a, b) : 7) << i << ", " << j;
    }
  }
  EXPECT_GT(outside, 0);
}

TEST_F(WarpCommand, InverseImageOfAWarpedImageIsTheImage) {
  const auto warp = [&](const char* moving, const char* output, bool inverse) {
    std::vector<std::string> arguments = {
        "warp",        "--transform",     file("spline.json"), "--moving",   file(moving),
        "--reference", file("image.mha"), "--output-image",    file(output), "--quiet"};
    if (inverse) arguments.emplace_back("--inverse");
    const auto run = run_crease(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
  };
  warp("image.mha", "there.mha", false);
  warp("there.mha", "back.mha", true);
  const auto image = read_image<2>(folder / "image.mha").image;
  const auto back = read_image<2>(folder / "back.mha").image;
  for (int j = 6; j < 26; ++j) {
    for (int i = 6; i < 34; ++i) EXPECT_NEAR(back(i, j), image(i, j), 0.02);  // interpolated twice
  }
}

TEST_F(WarpCommand, MapsMeshesAndKeepsTheirFaces) {
  const std::string mesh = folder.write("in.obj", "v 10 20 5\nv 1.5 -2 6\nv 3 4 7\nf 1 2 3\n");
  ASSERT_EQ(run_crease({"warp", "--transform", file("spline.json"), "--mesh", mesh, "--output-mesh",
                        file("out.off"), "--quiet"})
                .code,
            0);
  const auto spline = load_transform<2>(folder / "spline.json");
  const SurfaceMesh mapped = read_surface_mesh(folder / "out.off");
  ASSERT_EQ(mapped.vertices.size(), 3U);
  EXPECT_EQ(mapped.vertices[0].head<2>(), spline->map({10, 20}));
  EXPECT_EQ(mapped.vertices[0].z(), 5);  // a 2D transform knows none
  EXPECT_EQ(mapped.faces, (std::vector<std::vector<int>>{{0, 1, 2}}));
}

TEST_F(WarpCommand, MapsMeshesInSpace) {
  AffineMap<3> map;
  map.offset = {1, 2, 3};
  save_transform(AffineTransform<3>(map), folder / "shift.json");
  const std::string mesh = folder.write("in.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  ASSERT_EQ(run_crease({"warp", "--transform", file("shift.json"), "--inverse", "--mesh", mesh,
                        "--output-mesh", file("out.obj"), "--quiet"})
                .code,
            0);
  EXPECT_LT((read_surface_mesh(folder / "out.obj").vertices[1] - Point<3>(0, -2, -3)).norm(), 1e-9);
}

TEST_F(WarpCommand, InverseDisplacementUndoesTheTransform) {
  ASSERT_EQ(run_crease({"warp", "--transform", file("spline.json"), "--inverse", "--reference",
                        file("image.mha"), "--displacement", file("back.mha"), "--quiet"})
                .code,
            0);
  const auto back = read_displacement_field<2>(folder / "back.mha");
  const auto spline = load_transform<2>(folder / "spline.json");
  for (const auto& [i, j] : {std::pair{8, 9}, {20, 16}, {31, 25}}) {
    const Point<2> y = back.raster().point(Vector<2>(i, j));
    EXPECT_LT((spline->map(y + back(i, j)) - y).norm(), 1e-6);  // a millionth of a pixel
  }
}

TEST_F(WarpCommand, SingularMapsHaveNoInverse) {
  AffineMap<2> flat;
  flat.linear << 1, 0, 0, 0;
  save_transform(AffineTransform<2>(flat), folder / "flat.json");
  const std::string points = folder.write("in.csv", "x,y\n3,5\n");
  const auto run = run_crease({"warp", "--transform", file("flat.json"), "--inverse", "--points",
                               points, "--output-points", file("out.csv"), "--quiet"});
  EXPECT_EQ(run.code, 3);
  EXPECT_THAT(run.err, HasSubstr("singular and has no inverse"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out.csv"));
}

TEST_F(WarpCommand, RefusesContradictions) {
  const std::string t = file("turn.json"), m = file("image.mha");
  const auto refused = [&](const std::vector<std::string>& extra, int code, const char* text) {
    std::vector<std::string> arguments = {"warp"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    const auto run = run_crease(arguments);
    EXPECT_EQ(run.code, code) << ::testing::PrintToString(extra);
    EXPECT_THAT(run.err, ::testing::HasSubstr("crease warp: "));
    EXPECT_THAT(run.err, HasSubstr(text));
  };
  refused({}, 2, "--transform");
  refused({"--transform", t}, 2, "nothing to do");
  refused({"--transform", t, "--moving", m}, 2, "--moving needs --output-image");
  refused({"--transform", t, "--moving", m, "--output-image", "w.mha"}, 2, "--reference");
  refused({"--transform", t, "--points", m}, 2, "--points needs --output-points");
  refused({"--transform", t, "--output-mesh", "m.obj"}, 2, "--output-mesh needs --mesh");
  refused({"--transform", t, "--displacement", "u.mha"}, 2, "--reference");
  refused({"--transform", "none.json", "--displacement", "u.mha", "--reference", m}, 3,
          "none.json");
  refused({"--transform", m, "--displacement", "u.mha", "--reference", m}, 3, "image.mha");
  const std::string points = folder.write("p.csv", "x,y\n1,nan\n");
  refused({"--transform", t, "--points", points, "--output-points", file("o.csv")}, 3, "p.csv");
}

// A similarity of ITK about the origin: twice as large, turned by a right angle, and shifted.
TEST_F(WarpCommand, TakesTransformsOfItkInChains) {
  const std::string tfm = folder.write(
      "turn.tfm",
      "#Insight Transform File V1.0\nTransform: Similarity2DTransform_double_2_2\nParameters: 2 "
      "1.5707963267948966 5 6\nFixedParameters: 0 0\n");
  const std::string points = folder.write("in.csv", "x,y\n1,2\n");
  const auto run = run_crease({"warp", "--transform", tfm, "--transform", file("turn.json"),
                               "--points", points, "--output-points", file("out.csv"), "--quiet"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto row = rows(read_text(folder / "out.csv"))[0];
  EXPECT_NEAR(row[0], 30 - 8, 1e-12);  // (1, 2) -> (1, 8) -> (30 - 8, 4 + 1)
  EXPECT_NEAR(row[1], 4 + 1, 1e-12);
}

TEST_F(WarpCommand, DisplacementFieldsAreTransformsAndHaveInverses) {
  ASSERT_EQ(run_crease({"warp", "--transform", file("spline.json"), "--reference",
                        file("image.mha"), "--displacement", file("u.mha"), "--quiet"})
                .code,
            0);
  const std::string points = folder.write("in.csv", "x,y\n10,20\n4.5,9.1\n30,41\n");
  const auto warp = [&](const std::string& in, const std::string& out, bool inverse) {
    std::vector<std::string> arguments = {"warp",   "--transform",     file("u.mha"), "--points",
                                          in,       "--output-points", out,           "--json",
                                          "--quiet"};
    if (inverse) arguments.emplace_back("--inverse");
    const auto run = run_crease(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return nlohmann::json::parse(run.out);
  };
  EXPECT_FALSE(warp(points, file("there.csv"), false).contains("residual_mm"));
  const auto json = warp(file("there.csv"), file("back.csv"), true);
  EXPECT_EQ(json["unresolved"], 0);
  EXPECT_LT(json["residual_mm"]["max"], 1e-6);
  EXPECT_LE(json["residual_mm"]["mean"], json["residual_mm"]["max"]);
  const auto in = rows(read_text(points)), back = rows(read_text(folder / "back.csv"));
  for (std::size_t i = 0; i < in.size(); ++i) {
    EXPECT_NEAR(back[i][0], in[i][0], 1e-6);
    EXPECT_NEAR(back[i][1], in[i][1], 1e-6);
  }
}

TEST_F(WarpCommand, SaysHowGoodTheInverseIs) {
  const std::vector<std::string> arguments = {
      "warp",     "--transform",     file("spline.json"), "--inverse",
      "--moving", file("image.mha"), "--reference",       file("image.mha"),
      "--quiet",  "--output-image",  file("w.mha")};
  const auto run = run_crease(arguments);
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("T(T^-1(y)) - y: mean "));
  EXPECT_THAT(run.out, HasSubstr(" 0 of 1280 unresolved"));
}

TEST_F(WarpCommand, KeepsLargeLabelsExactly) {
  Raster<2> raster;
  raster.size = {40, 32};
  Image<std::int32_t, 2> labels(raster);
  for (std::size_t k = 0; k < labels.values().size(); ++k) {
    labels.values()[k] = 1'000'000'001 + static_cast<int>(k % 7);
  }
  write_image(folder / "large.mha", labels, PixelType::kUint32);
  save_transform(AffineTransform<2>(), folder / "rest.json");
  const auto run = run_crease(
      {"warp", "--transform", file("rest.json"), "--moving", file("large.mha"), "--reference",
       file("large.mha"), "--output-image", file("w.mha"), "--interpolator", "nearest", "--quiet"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(read_labels<2>(folder / "w.mha").values(), labels.values());
  EXPECT_EQ(read_image_header(folder / "w.mha").pixel_type, PixelType::kUint32);
}

TEST_F(WarpCommand, MapsPointsOfOtherProgramsAndKeepsTheRest) {
  AffineMap<3> map;
  map.offset = {1, 2, 3};
  save_transform(AffineTransform<3>(map), folder / "shift.json");
  const auto warp = [&](const char* what, const std::string& name, const std::string& text) {
    const std::string in = folder.write(name, text), out = file("out-" + name);
    const auto run = run_crease({"warp", "--transform", file("shift.json"), message("--", what), in,
                                 message("--output-", what), out, "--quiet"});
    EXPECT_EQ(run.code, 0) << run.err;
    return read_text(out);
  };
  const std::string vtk = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n";
  for (const char* what : {"points", "mesh"}) {
    EXPECT_EQ(warp(what, "a.vtk", vtk + "POINTS 1 float\n0 0 0.5\nVERTICES 1 2\n1 0\n"),
              vtk + "POINTS 1 double\n1 2 3.5\nVERTICES 1 2\n1 0\n");
  }
  EXPECT_EQ(warp("points", "a.fcsv", "# CoordinateSystem = RAS\nid,10,10,10,0,0,0,1,1,1,0,F\n"),
            "# CoordinateSystem = RAS\nid,9,8,13,0,0,0,1,1,1,0,F\n");
  const auto json = nlohmann::json::parse(
      warp("points", "a.mrk.json",
           R"({"markups": [{"type": "Fiducial", "coordinateSystem": "LPS", "display": {"a": 1},
               "controlPoints": [{"label": "F", "position": [1, 1, 1]}]}]})"));
  EXPECT_EQ(json["markups"][0]["controlPoints"][0]["position"], (std::vector<double>{2, 3, 4}));
  EXPECT_EQ(json["markups"][0]["display"]["a"], 1);
  EXPECT_THAT(warp("mesh", "a.stl",
                   "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                   "vertex 0 1 0\nendloop\nendfacet\nendsolid\n"),
              HasSubstr("vertex 2 2 3\n"));
}

TEST_F(WarpCommand, RefusesDamagedFiles) {
  const std::string points = folder.write("p.csv", "x,y\n1,2\n"), out = file("o.csv");
  const auto refused = [&](const std::string& transform, const char* text) {
    const auto run = run_crease(
        {"warp", "--transform", transform, "--points", points, "--output-points", out, "--quiet"});
    EXPECT_EQ(run.code, 3) << transform;
    EXPECT_THAT(run.err, ::testing::AllOf(HasSubstr(transform), HasSubstr(text)));
    EXPECT_FALSE(std::filesystem::exists(out));
  };
  refused(folder.write("a.tfm", "nothing\n"), "does not begin with \"#Insight Transform File\"");
  refused(folder.write("b.tfm",
                       "#Insight Transform File V1.0\nTransform: "
                       "AffineTransform_double_2_2\nParameters: 1 0 0"),
          "may be cut off");
  refused(folder.write("c.tfm",
                       "#Insight Transform File V1.0\nTransform: "
                       "SplineOfTheFuture_double_2_2\nParameters: 1\n"),
          "SplineOfTheFuture_double_2_2 is of a class that crease has no equal of");
  refused(folder.write("a.h5", "nothing"), "is not an HDF5 file");
  refused(folder.write("a.mat", "nothing that Matlab wrote"), "is no file of Matlab 4");
  refused(folder.write("a.json", "{}"), "is not a transform file");
  refused(file("none.h5"), "no such file");
  refused(file("labels.mha"), "1 number per pixel; a displacement field has 2");
  DisplacementField<2> field(read_image<2>(folder / "image.mha").image.raster());
  field(4, 7)[1] = std::nan("");
  write_displacement_field(folder / "nan.mha", field);
  refused(file("nan.mha"), "the displacement of pixel (4, 7) is not finite");
}

TEST_F(WarpCommand, RefusesPointsThatItCannotMap) {
  save_transform(AffineTransform<3>(), folder / "rest3.json");
  const auto refused = [&](const char* transform, const std::string& in, const char* out,
                           const char* text) {
    const auto run = run_crease({"warp", "--transform", file(transform), "--points", in,
                                 "--output-points", file(out), "--quiet"});
    EXPECT_EQ(run.code, 3) << run.err;
    EXPECT_THAT(run.err, HasSubstr(text));
  };
  const std::string csv = folder.write("p.csv", "x,y\n1,2\n");
  refused("rest3.json", csv, "o.csv", "has no column 'z', which a 3D transform needs");
  refused("turn.json", csv, "o.vtk", "name a file that ends in .csv");
  refused("turn.json", folder.write("p.vtk", "# vtk DataFile Version 3.0\nt\nASCII\n"), "o.vtk",
          "p.vtk: ends within its header");
  refused("turn.json", folder.write("p.mrk.json", "{"), "o.mrk.json", "is not a markups file");
  refused("turn.json", folder.write("p.xyz", "1 2 3\n"), "o.xyz",
          "the form of points is not known");
}

TEST_F(WarpCommand, TellsItsFiguresAsJson) {
  const std::string points = folder.write("in.csv", "x,y\n10,20\n");
  const auto run = run_crease({"warp", "--transform", file("turn.json"), "--points", points,
                               "--output-points", file("out.csv"), "--json", "--quiet"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["command"], "warp");
  EXPECT_EQ(json["num_points"], 1);
  EXPECT_EQ(json["inputs"].size(), 2u);
}

}  // namespace
}  // namespace crease
