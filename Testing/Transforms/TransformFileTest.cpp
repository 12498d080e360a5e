#include "Transforms/TransformFile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "Core/Error.h"
#include "Testing/Transforms/SampleNurbs.h"
#include "Testing/Transforms/Splines/TestNets.h"
#include "Transforms/DisplacementFieldTransform.h"
#include "Transforms/RigidTransform.h"
#include "Transforms/Splines/PowellSabinBasis.h"
#include "Transforms/Splines/PowellSabinCreases.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
namespace fs = std::filesystem;

class TransformFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(::testing::TempDir()) /
        (std::string("crease_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path file() const { return folder_ / "transform.json"; }
  std::string text() const {
    std::ifstream stream(file());
    std::stringstream content;
    content << stream.rdbuf();
    return content.str();
  }
  void write(const std::string& content) const { std::ofstream(file()) << content; }
  /// Replaces one text of the file by another.
  void change(const std::string& from, const std::string& to) const {
    std::string content = text();
    const auto at = content.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write(content.replace(at, from.size(), to));
  }
  void save_spline() const {
    SplineTransform<2> transform(testing::small_basis<2>());
    save_transform(transform, file());
  }
  void expect_error(const std::string& part) const {
    EXPECT_THAT(
        [&] { load_transform<2>(file()); },
        ThrowsMessage<FileError>(::testing::AllOf(HasSubstr(file().string()), HasSubstr(part))));
  }

 private:
  fs::path folder_;
};

}  // namespace

TEST_F(TransformFile, LeavesNoTemporaryFile) {
  save_spline();
  int files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(file().parent_path())) ++files;
  EXPECT_EQ(files, 1);
}

TEST_F(TransformFile, KeepsTheWholeSplineAndNothingElse) {
  AffineMap<2> affine;
  affine.linear << 0.1, 1.0 / 3, -2.0 / 7, 1e-300;
  affine.offset = {1e17, -0.0};
  const SplineTransform<2> transform(testing::small_basis<2>(4, 0.77), affine);
  save_transform(transform, file());
  const auto loaded = load_transform<2>(file());
  const auto& spline = dynamic_cast<const SplineTransform<2>&>(*loaded);
  EXPECT_EQ(spline.affine().linear, affine.linear);
  EXPECT_EQ(spline.affine().offset, affine.offset);
  EXPECT_TRUE(std::signbit(spline.affine().offset[1]));
  const auto& basis = dynamic_cast<const TensorBSplineBasis<2>&>(spline.basis());
  const auto& expected = dynamic_cast<const TensorBSplineBasis<2>&>(transform.basis());
  EXPECT_EQ(basis.degree(), 4);
  EXPECT_EQ(basis.lattice().spans, expected.lattice().spans);
  EXPECT_EQ(basis.lattice().direction, expected.lattice().direction);
  EXPECT_EQ(basis.lattice().origin, expected.lattice().origin);
  EXPECT_EQ(basis.lattice().spacing, expected.lattice().spacing);
}

TEST_F(TransformFile, KeepsTheWholeKnotNet) {
  auto net = testing::ring_net(3, 0.3, true);
  ASSERT_FALSE(net.crease_edges.empty());
  const SplineTransform<2> transform(std::make_shared<TriangularBSplineBasis<2>>(net));
  save_transform(transform, file());
  const auto loaded = load_transform<2>(file());
  const auto& again = dynamic_cast<const TriangularBSplineBasis<2>&>(
                          dynamic_cast<const SplineTransform<2>&>(*loaded).basis())
                          .net();
  EXPECT_EQ(again.degree, net.degree);
  EXPECT_EQ(again.mesh.vertices, net.mesh.vertices);
  EXPECT_EQ(again.mesh.simplices, net.mesh.simplices);
  EXPECT_EQ(again.mesh.regions, net.mesh.regions);
  EXPECT_EQ(again.clouds, net.clouds);
  ASSERT_EQ(again.crease_edges.size(), net.crease_edges.size());
  for (std::size_t e = 0; e < net.crease_edges.size(); ++e) {
    EXPECT_EQ(again.crease_edges[e].vertices, net.crease_edges[e].vertices);
    EXPECT_EQ(again.crease_edges[e].body_side, net.crease_edges[e].body_side);
  }

  change("\"body_side\": true", "\"body_side\": 1");
  expect_error("\"basis.crease_edges[0].body_side\" is not true or false");
  save_transform(transform, file());
  change("\"degree\": 3", "\"degree\": 2");
  expect_error("its contents contradict each other");
}

TEST_F(TransformFile, KeepsTheWholePowellSabinNet) {
  DomainMesh domain;
  domain.mesh = testing::ring_net(2, 0.3, true).mesh;
  domain.chains.emplace_back();
  domain.chains[0].closed = true;
  domain.chains[0].body = BodySide::kLeft;
  for (int k = 0; k < 12; ++k) domain.chains[0].vertices.push_back(13 + k);
  PowellSabinNet net = place_powell_sabin(domain);
  ASSERT_EQ(net.crease_edges.size(), 12U);
  auto corners = net.vertices[5].corners.topRows<2>();  // not where they would be placed
  corners = (1.25 * corners).colwise() - 0.25 * net.mesh.vertices[5];
  const auto save = [&] {
    save_transform(SplineTransform<2>(std::make_shared<PowellSabinBasis>(net)), file());
  };
  save();
  const auto loaded = load_transform<2>(file());
  const auto& again = dynamic_cast<const PowellSabinBasis&>(
                          dynamic_cast<const SplineTransform<2>&>(*loaded).basis())
                          .net();
  EXPECT_EQ(again.mesh.vertices, net.mesh.vertices);
  EXPECT_EQ(again.mesh.simplices, net.mesh.simplices);
  EXPECT_EQ(again.mesh.regions, net.mesh.regions);
  ASSERT_EQ(again.vertices.size(), net.vertices.size());
  for (std::size_t v = 0; v < net.vertices.size(); ++v) {
    EXPECT_EQ(again.vertices[v].corners, net.vertices[v].corners);
    EXPECT_EQ(again.vertices[v].normal, net.vertices[v].normal);
  }
  ASSERT_EQ(again.crease_edges.size(), net.crease_edges.size());
  for (std::size_t e = 0; e < net.crease_edges.size(); ++e) {
    EXPECT_EQ(again.crease_edges[e].vertices, net.crease_edges[e].vertices);
    EXPECT_EQ(again.crease_edges[e].body_side, net.crease_edges[e].body_side);
  }

  change("\"corners\": [", "\"corners\": [[1, 2],");
  expect_error("\"basis.corners[0]\" has 2 numbers");
  save();
  change("\"corners\": [", "\"corners\": [[0, 0, 1, 0, 0, 1],");
  expect_error("its contents contradict each other");
  save();
  change("\"simplices\": [", "\"simplices\": [[0, 1, 2],");
  expect_error("does not have one number per simplex");
}

TEST_F(TransformFile, KeepsTheWholeNurbsNet) {
  const auto net = testing::rational_net<2>(testing::small_lattice<2>(), 3);
  save_transform(SplineTransform<2>(std::make_shared<NurbsBasis<2>>(net)), file());
  const auto loaded = load_transform<2>(file());
  const auto& again =
      dynamic_cast<const NurbsBasis<2>&>(dynamic_cast<const SplineTransform<2>&>(*loaded).basis())
          .net();
  EXPECT_EQ(again.degree, net.degree);
  EXPECT_EQ(again.knots, net.knots);
  EXPECT_EQ(again.weights, net.weights);
  EXPECT_EQ(again.origin, net.origin);
  EXPECT_EQ(again.direction, net.direction);

  change("\"affine_maps\": true", "\"affine_maps\": 1");
  expect_error("\"basis.affine_maps\" is not true or false");
  save_transform(SplineTransform<2>(std::make_shared<NurbsBasis<2>>(net)), file());
  change("\"weights\": [", "\"weights\": [ 7.5,");
  expect_error("weights given for");
  save_transform(SplineTransform<2>(std::make_shared<NurbsBasis<2>>(net)), file());
  change("\"weights\": [", "\"weights\": [ {},");
  expect_error("\"basis.weights[0]\" is not a number");
  save_transform(SplineTransform<2>(std::make_shared<NurbsBasis<2>>(net)), file());
  change("\"knots\": [", "\"knots\": [ [],");
  expect_error("\"basis.knots\" does not have 2 lists");
}

TEST_F(TransformFile, KeepsTheWholeTMesh) {
  const auto basis = testing::tspline(testing::small_lattice<2>(), 3);
  const auto save = [&] { save_transform(SplineTransform<2>(basis), file()); };
  save();
  const auto loaded = load_transform<2>(file());
  const auto& again =
      dynamic_cast<const TSplineBasis&>(dynamic_cast<const SplineTransform<2>&>(*loaded).basis());
  EXPECT_EQ(again.mesh(), basis->mesh());
  EXPECT_EQ(again.box().origin, basis->box().origin);
  EXPECT_EQ(again.box().direction, basis->box().direction);

  change("\"segments\": [", "\"segments\": [ [2, 0, 0, 1],");
  expect_error("\"basis.segments[0][0]\" is 2");
  save();
  change("\"segments\": [", "\"segments\": [ [0, 0, 1],");
  expect_error("\"basis.segments[0]\" does not have 4 numbers");
  save();
  change("\"segments\": [", "\"segments\": [ [0, 4, 2, 999],");
  expect_error("does not lie on the lines");
  save();
  change("\"lines\"", "\"Lines\"");
  expect_error("\"basis.lines\" is missing");
}

TEST_F(TransformFile, PeekTellsDimensionsAndType) {
  save_transform(RigidTransform<3>(), file());
  const auto info = peek_transform(file());
  EXPECT_EQ(info.in_dim, 3);
  EXPECT_EQ(info.out_dim, 3);
  EXPECT_EQ(info.type, "rigid");
}

TEST_F(TransformFile, RefusesOtherDimensions) {
  save_transform(RigidTransform<3>(), file());
  expect_error("from 3D to 3D");
}

TEST_F(TransformFile, NamesAMissingFile) { expect_error("cannot be opened"); }

TEST_F(TransformFile, RefusesWhatIsNoTransform) {
  write("{\"a\": 1}");
  expect_error("is not a transform file");
  write("fixed_x,fixed_y\n1,2\n");
  expect_error("is not a complete JSON file");
  write("[1, 2]");
  expect_error("is not a transform file");
}

TEST_F(TransformFile, RefusesATruncatedFile) {
  save_spline();
  write(text().substr(0, text().size() / 2));
  expect_error("is not a complete JSON file");
}

TEST_F(TransformFile, RefusesALaterVersion) {
  save_spline();
  change("\"version\": 1", "\"version\": 2");
  expect_error("version 2");
}

TEST_F(TransformFile, NamesTheEntryAtFault) {
  save_spline();
  change("\"degree\": 3", "\"degree\": 9");
  expect_error("\"basis.degree\" is 9");
  save_spline();
  change("\"degree\": 3", "\"degree\": 2");
  expect_error("\"control_points\" has");
  save_spline();
  change("\"spacing\"", "\"Spacing\"");
  expect_error("\"basis.spacing\" is missing");
  save_spline();
  change("\"kind\": \"tensor\"", "\"kind\": \"wavelet\"");
  expect_error("\"wavelet\" is unknown");
  save_spline();
  change("\"type\": \"spline\"", "\"type\": \"magic\"");
  expect_error("\"magic\" is unknown");
  save_spline();
  change("\"affine_offset\": [\n  0.0,", "\"affine_offset\": [\n  null,");
  expect_error("\"affine_offset[0]\" is not a number");
}

TEST_F(TransformFile, DisplacementFieldsTakeSinglePrecisionWhereThatIsExact) {
  Raster<2> raster;
  raster.size = {3, 2};
  raster.spacing = {0.1, 7};
  DisplacementFieldTransform<2> field(raster);
  field.set_parameters(Eigen::VectorXd::LinSpaced(12, -1.5, 4));
  save_transform(field, file());
  EXPECT_EQ(peek_transform(file()).type, "displacement field");
  EXPECT_EQ(peek_transform(file()).format, "crease");
  EXPECT_THAT(text(), HasSubstr("\"base64 float32\""));
  EXPECT_EQ(load_transform<2>(file())->parameters(), field.parameters());
  field.set_parameters(Eigen::VectorXd::Constant(12, 0.1));
  save_transform(field, file());
  EXPECT_THAT(text(), HasSubstr("\"base64 float64\""));
  EXPECT_EQ(load_transform<2>(file())->parameters(), field.parameters());

  change("mpmZ", "mpm");
  expect_error("\"displacements\" is not base64 float64, or is cut off");
  save_transform(field, file());
  change("\"size\": [\n  3,", "\"size\": [\n  4,");
  expect_error("\"displacements\" has 12 numbers instead of 16");
  save_transform(field, file());
  change("\"base64 float64\"", "\"hex\"");
  expect_error("\"displacements\" is not hex");
  save_transform(field, file());
  change("\"spacing\": [\n  0.1", "\"spacing\": [\n  -0.1");
  expect_error("the spacing of axis 0 is -0.1");
}

TEST_F(TransformFile, SaysWhenItCannotWrite) {
  EXPECT_THAT([&] { save_transform(RigidTransform<2>(), file() / "below" / "a.json"); },
              ThrowsMessage<FileError>(HasSubstr("does not exist")));
}

}  // namespace crease
