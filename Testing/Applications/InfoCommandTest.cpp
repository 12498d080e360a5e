#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "Images/ImageFile.h"
#include "Testing/Applications/CommandRunner.h"
#include "Testing/TemporaryFolder.h"
#include "Transforms/CauchyNavierTransform.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Domains/StructuredTriangulation.h"
#include "Transforms/RigidTransform.h"
#include "Transforms/SimilarityTransform.h"
#include "Transforms/SplineTransform.h"
#include "Transforms/Splines/NurbsBasis.h"
#include "Transforms/Splines/PowellSabinBasis.h"
#include "Transforms/Splines/ThinPlateBasis.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"
#include "Transforms/TransformFile.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using testing::run_crease;

class InfoCommand : public ::testing::Test {
 protected:
  nlohmann::json info(const std::string& file) const {
    const auto run = run_crease({"info", file, "--json"});
    EXPECT_EQ(run.code, 0) << run.err;
    return nlohmann::json::parse(run.out);
  }
  template <int Dim>
  nlohmann::json info_of(std::shared_ptr<const SplineBasis<Dim>> basis) const;
  testing::TemporaryFolder folder;
};

TEST_F(InfoCommand, DescribesImages) {
  Raster<2> raster;
  raster.size = {5, 4};
  raster.spacing = {0.5, 2};
  raster.origin = {-1, 7};
  Image<float, 2> image(raster, 1);
  image(1, 1) = -3;
  image(2, 1) = std::numeric_limits<float>::quiet_NaN();
  const std::string file = (folder / "image.mha").string();
  write_image(file, image, PixelType::kFloat);
  const auto json = info(file);
  EXPECT_EQ(json["kind"], "image");
  EXPECT_EQ(json["size"], (std::vector<int>{5, 4}));
  EXPECT_EQ(json["spacing_mm"], (std::vector<double>{0.5, 2}));
  EXPECT_EQ(json["origin_mm"], (std::vector<double>{-1, 7}));
  EXPECT_EQ(json["type"], "float");
  EXPECT_EQ(json["min"], -3);
  EXPECT_EQ(json["max"], 1);
  EXPECT_EQ(json["not_finite"], 1);
  const auto text = run_crease({"info", file}).out;
  for (const char* part : {"MetaImage", "5 x 4 pixels", "spacing 0.5 x 2 mm", "1 not finite"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

TEST_F(InfoCommand, DescribesTriangularSplines) {
  Box<2> box;
  box.lower = {0, 0};
  box.upper = {6, 6};
  FeatureLine line;
  line.points = {{1, 3}, {3, 1}, {5, 3}, {3, 5}};
  line.closed = true;
  const auto mesh = attach_feature_lines(structured_triangulation(box, 6, 6), {line});
  const auto basis = std::make_shared<const TriangularBSplineBasis<2>>(place_knots(mesh).net);
  const std::string file = (folder / "t.json").string();
  save_transform(SplineTransform<2>(basis), file);
  const auto json = info(file);
  EXPECT_EQ(json["kind"], "transform");
  EXPECT_EQ(json["type"], "spline");
  EXPECT_EQ(json["basis"], "triangular");
  EXPECT_EQ(json["degree"], 3);
  EXPECT_EQ(json["simplices"], 72);
  EXPECT_EQ(json["control_points"], 361);
  EXPECT_EQ(json["crease_edges"], 8);
  EXPECT_THAT(run_crease({"info", file}).out, HasSubstr("72 triangles"));
}

/// What `crease info --json` says of the identity in a basis.
template <int Dim>
nlohmann::json InfoCommand::info_of(std::shared_ptr<const SplineBasis<Dim>> basis) const {
  const std::string file = (folder / "basis.json").string();
  save_transform(SplineTransform<Dim>(std::move(basis)), file);
  return info(file);
}

TEST_F(InfoCommand, DescribesOtherSplines) {
  Box<2> box;
  box.lower = {0, 0};
  box.upper = {6, 6};
  const auto mesh = structured_triangulation(box, 3, 3);
  const auto sabin = info_of<2>(std::make_shared<PowellSabinBasis>(mesh));
  EXPECT_EQ(sabin["basis"], "powell-sabin");
  EXPECT_EQ(sabin["simplices"], 18);
  EXPECT_EQ(sabin["vertices"], 16);
  EXPECT_EQ(sabin["control_points"], 48);
  Raster<3> raster;
  raster.size = {7, 7, 7};
  const auto plate = covering_thin_plate<3>(raster, 3);
  const auto thin = info_of<3>(plate);
  EXPECT_EQ(thin["basis"], "thin-plate");
  EXPECT_EQ(thin["control_points"], plate->num_control_points());
  NurbsNet<2> net;
  net.degree = 2;
  net.knots = {{{0, 0, 0, 2, 6, 6, 6}, {0, 0, 0, 6, 6, 6}}};
  const auto nurbs = info_of<2>(std::make_shared<NurbsBasis<2>>(net));
  EXPECT_EQ(nurbs["basis"], "nurbs");
  EXPECT_EQ(nurbs["functions"], (std::vector<int>{4, 3}));
  EXPECT_FALSE(nurbs["rational"].get<bool>());
}

TEST_F(InfoCommand, DescribesElasticBodiesAndSimilarities) {
  ControlPoints<2> centres(2, 4);
  centres << 0, 4, 4, 0, 0, 0, 4, 4;
  const std::string file = (folder / "t.json").string();
  save_transform(CauchyNavierTransform<2>(centres, 0.25), file);
  const auto elastic = info(file);
  EXPECT_EQ(elastic["centres"], 4);
  EXPECT_EQ(elastic["poisson_ratio"], 0.25);
  AffineMap<2> twice;
  twice.linear *= 2;
  save_transform(SimilarityTransform<2>(twice), file);
  const auto similarity = info(file);
  EXPECT_DOUBLE_EQ(similarity["scale"].get<double>(), 2);
  EXPECT_EQ(similarity["matrix"].size(), 2u);
}

TEST_F(InfoCommand, DescribesChains) {
  std::vector<std::unique_ptr<Transform<3>>> parts;
  parts.push_back(std::make_unique<RigidTransform<3>>());
  parts.push_back(std::make_unique<RigidTransform<3>>());
  const std::string file = (folder / "chain.json").string();
  save_transform(CompositeTransform<3>(std::move(parts)), file);
  const auto json = info(file);
  EXPECT_EQ(json["type"], "composite");
  EXPECT_EQ(json["in_dimension"], 3);
  EXPECT_EQ(json["parts"].size(), 2u);
}

TEST_F(InfoCommand, DescribesTables) {
  const auto landmarks =
      info(folder.write("l.csv", "fixed_x,fixed_y,moving_x,moving_y\n0,0,3,4\n1,1,1,1\n"));
  EXPECT_EQ(landmarks["kind"], "landmarks");
  EXPECT_EQ(landmarks["count"], 2);
  EXPECT_EQ(landmarks["distance_mm"]["max"], 5);
  const auto lines =
      info(folder.write("f.csv", "line,x,y\n1,0,0\n1,3,0\n1,3,4\n1,0,0\n2,5,5\n2,6,5\n"));
  EXPECT_EQ(lines["kind"], "feature lines");
  EXPECT_EQ(lines["count"], 2);
  EXPECT_TRUE(lines["lines"][0]["closed"].get<bool>());
  EXPECT_EQ(lines["lines"][0]["length_mm"], 12);
  const auto region = info(folder.write("r.csv", "ring,x,y\n0,0,0\n0,4,0\n0,4,5\n0,0,5\n"));
  EXPECT_EQ(region["kind"], "region of interest");
  EXPECT_EQ(region["area_mm2"], 20);
}

TEST_F(InfoCommand, DescribesPoints) {
  const auto table = info(folder.write("p.csv", "x,y,name\n1,2,a\n-3,5,b\n"));
  EXPECT_EQ(table["kind"], "points");
  EXPECT_EQ(table["count"], 2);
  EXPECT_EQ(table["lower_mm"], (std::vector<double>{-3, 2}));
  const auto old_list =
      info(folder.write("p.fcsv", "# CoordinateSystem = RAS\n1,1,2,3,0,0,0,1,1,1,0,a,,\n"));
  EXPECT_EQ(old_list["kind"], "points");
  EXPECT_EQ(old_list["upper_mm"], (std::vector<double>{-1, -2, 3}));
  const auto list = info(folder.write(
      "p.mrk.json", R"({"markups":[{"type":"Fiducial","coordinateSystem":"LPS","controlPoints":)"
                    R"([{"label":"a","position":[1,2,3]},{"label":"b","position":[4,5,6]}]}]})"));
  EXPECT_EQ(list["kind"], "points");
  EXPECT_EQ(list["count"], 2);
  const auto curve = info(folder.write(
      "c.mrk.json", R"({"markups":[{"type":"Curve","coordinateSystem":"LPS","controlPoints":)"
                    R"([{"label":"a","position":[1,2,0]},{"label":"b","position":[4,6,0]}]}]})"));
  EXPECT_EQ(curve["kind"], "feature lines");
  EXPECT_EQ(curve["lines"][0]["length_mm"], 5);
}

TEST_F(InfoCommand, DescribesMeshes) {
  const std::string file = folder.write("m.obj",
                                        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\n"
                                        "f 2 3 4\nf 3 1 4\n");
  const auto json = info(file);
  EXPECT_EQ(json["kind"], "mesh");
  EXPECT_EQ(json["vertices"], 4);
  EXPECT_EQ(json["faces"], 4);
  EXPECT_EQ(json["boundary_loops"], 0);
  EXPECT_EQ(json["genus"], 0);
  EXPECT_EQ(json["upper_mm"], (std::vector<double>{1, 1, 2}));
  EXPECT_THAT(run_crease({"info", file}).out,
              ::testing::AllOf(HasSubstr("4 vertices"), HasSubstr("genus 0")));
}

TEST_F(InfoCommand, DescribesAffineTransformsAndVolumes) {
  save_transform(RigidTransform<3>(), folder / "r.json");
  const auto rigid = info((folder / "r.json").string());
  EXPECT_EQ(rigid["type"], "rigid");
  EXPECT_EQ(rigid["parameters"], 6);
  Raster<3> raster;
  raster.size = {3, 4, 5};
  write_displacement_field(folder / "u.nii.gz", DisplacementField<3>(raster, Vector<3>(1, -2, 3)));
  const auto field = info((folder / "u.nii.gz").string());
  EXPECT_EQ(field["kind"], "image");
  EXPECT_EQ(field["dimension"], 3);
  EXPECT_EQ(field["components"], 3);
  EXPECT_EQ(field["size"], (std::vector<int>{3, 4, 5}));
}

TEST_F(InfoCommand, RefusesWhatItDoesNotUnderstand) {
  const auto refused = [](const std::string& file, int code, const char* text) {
    const auto run = run_crease({"info", file});
    EXPECT_EQ(run.code, code);
    EXPECT_THAT(run.err, HasSubstr(text));
  };
  refused("nowhere.png", 3, "nowhere.png");
  refused(folder.write("t.csv", "a,b\n1,2\n"), 3, "t.csv");
  refused(folder.write("t.json", "{}"), 3, "t.json");
  EXPECT_EQ(run_crease({"info"}).code, 2);
}

TEST_F(InfoCommand, DescribesTransformsOfItkAndFields) {
  const auto affine = info(folder.write("a.tfm",
                                        "#Insight Transform File V1.0\nTransform: "
                                        "TranslationTransform_double_2_2\nParameters: 3 4\n"));
  EXPECT_EQ(affine["kind"], "transform");
  EXPECT_EQ(affine["type"], "affine");
  EXPECT_EQ(affine["format"], "ITK text");
  EXPECT_EQ(affine["offset_mm"], (std::vector<double>{3, 4}));
  EXPECT_EQ(affine["matrix"][1], (std::vector<double>{0, 1}));
  const auto field = info(folder.write("f.tfm",
                                       "#Insight Transform File V1.0\nTransform: "
                                       "DisplacementFieldTransform_double_2_2\nParameters: 0 0 "
                                       "3 4\nFixedParameters: 2 1 0 0 1 1 1 0 0 1\n"));
  EXPECT_EQ(field["type"], "displacement field");
  EXPECT_EQ(field["size"], (std::vector<int>{2, 1}));
  EXPECT_EQ(field["largest_displacement_mm"], 5);
  const auto run = run_crease({"info", (folder / "f.tfm").string()});
  EXPECT_THAT(run.out, HasSubstr("displacement field transform, 2D to 2D (ITK text)"));
}

TEST_F(InfoCommand, DescribesPointsOfVtk) {
  const auto json = info(folder.write(
      "a.vtk",
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n0 1 2 3 4 5\n"));
  EXPECT_EQ(json["kind"], "points");
  EXPECT_EQ(json["count"], 2);
  EXPECT_EQ(json["upper_mm"], (std::vector<double>{3, 4, 5}));
}

}  // namespace
}  // namespace crease
