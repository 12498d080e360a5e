// What the user reads when input is bad: one message that names file and option, and the exit code.
#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "Core/Error.h"
#include "Images/MakeInterpolator.h"
#include "Images/Resample.h"
#include "Testing/Applications/RegisterFixture.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/TransformFile.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class RegisterBadInput : public testing::RegisterFixture {
 protected:
  Image<float, 2> plain(int size, float value = 1) const {
    Raster<2> raster;
    raster.size = {size, size};
    return Image<float, 2>(raster, value);
  }
  std::string save(const std::string& name, const Image<float, 2>& image) const {
    write_image(folder / name, image, PixelType::kFloat);
    return (folder / name).string();
  }
};

TEST_F(RegisterBadInput, ImageThatIsMissingOrUnreadable) {
  expect_refused(run_with("nowhere.mha", image("moving.mha"), {}), 3, {"nowhere.mha"});
  const std::string text = folder.write("text.png", "this is no image");
  expect_refused(run_with(image("fixed.mha"), text, {}), 3, {"text.png"});
}

TEST_F(RegisterBadInput, ImageThatIsEmptyOrAFolder) {
  const std::string empty = folder.write("empty.mha", "");
  expect_refused(run_with(image("fixed.mha"), empty, {}), 3, {"empty.mha"});
  expect_refused(run_with(folder.path().string(), image("moving.mha"), {}), 3,
                 {folder.path().string()});
}

TEST_F(RegisterBadInput, ImagesThatAreNeitherFlatNorVolumes) {
  for (const auto& [dimension, size] : {std::pair("1", "16"), {"4", "2 2 2 2"}}) {
    const std::string file = folder.write(
        "image.mha",
        message("ObjectType = Image\nNDims = ", dimension, "\nBinaryData = True\nDimSize = ", size,
                "\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n", std::string(16, 'x')));
    expect_refused(run_with(file, image("moving.mha"), {}), 3,
                   {"image.mha", std::string(dimension) + " dimension"});
  }
}

TEST_F(RegisterBadInput, ImageWithPixelsThatAreNotFinite) {
  auto bad = plain(32);
  bad(4, 7) = std::numeric_limits<float>::quiet_NaN();
  bad(5, 7) = std::numeric_limits<float>::infinity();
  expect_refused(run_with(image("fixed.mha"), save("nan.mha", bad), {}), 3,
                 {"nan.mha", "2 pixels", "(4, 7)"});
}

TEST_F(RegisterBadInput, ImagesOfDifferentDimension) {
  Raster<3> raster;
  raster.size = {8, 8, 8};
  write_image(folder / "volume.mha", Image<float, 3>(raster), PixelType::kFloat);
  expect_refused(run_with(image("fixed.mha"), (folder / "volume.mha").string(), {}), 3,
                 {"fixed.mha is 2D", "volume.mha is 3D"});
  for (const char* option : {"--fixed-mask", "--moving-mask", "--rigid-labels", "--roi"}) {
    expect_refused(run({option, (folder / "volume.mha").string()}), 3, {"volume.mha", "3"});
  }
}

TEST_F(RegisterBadInput, ImagesThatDoNotOverlap) {
  const auto far = read_image<2>(image("moving.mha")).image;
  Raster<2> raster = far.raster();
  raster.origin = {1000, 2000};
  write_image(folder / "far.mha", Image<float, 2>(raster, far.values()), PixelType::kFloat);
  expect_refused(run_with(image("fixed.mha"), (folder / "far.mha").string(), {}), 3,
                 {"do not overlap", "(-0.5, -0.5) to (63.5, 63.5)", "(999.5, 1999.5)"});
}

TEST_F(RegisterBadInput, StartThatLeadsAway) {
  AffineMap<2> far;
  far.offset = {1000, 0};
  save_transform(AffineTransform<2>(far), folder / "far.json");
  for (const char* transform : {"triangular-bspline", "rigid"}) {
    std::vector<std::string> extra = {"--init", (folder / "far.json").string(), "--transform",
                                      transform};
    expect_refused(run(extra), 3, {"do not overlap", "(999.5, -0.5) to (1063.5, 63.5)"});
  }
}

// The same scene through another grid: spacing, origin and direction are no reason to refuse.
TEST_F(RegisterBadInput, OtherSpacingOriginAndDirectionAreNoError) {
  const auto moving = read_image<2>(image("moving.mha")).image;
  Raster<2> raster;
  raster.size = {120, 100};
  raster.spacing = {0.55, 0.65};
  raster.origin = {65, -1};
  raster.direction << 0, -1, 1, 0;
  const auto cubic = make_interpolator(moving, InterpolationKind::kCubic);
  const auto again = resample<2>(*cubic, raster, [](const Point<2>& x) { return x; });
  ASSERT_EQ(run_with(image("fixed.mha"), save("again.mha", again), {"--gamma", "0.01"}).code, 0);
  const auto there = read_displacement_field<2>(folder / "out/displacement.mha");
  ASSERT_EQ(run({"--gamma", "0.01"}).code, 0);
  const auto here = read_displacement_field<2>(folder / "out/displacement.mha");
  double sum = 0;
  for (int j = 4; j < 60; ++j) {
    for (int i = 4; i < 60; ++i) sum += (there(i, j) - here(i, j)).squaredNorm();
  }
  // Pixels: the finest level smooths each image over its own pixels, not the same here.
  EXPECT_LT(std::sqrt(sum / (56 * 56)), 0.2);
}

TEST_F(RegisterBadInput, RegionOfInterest) {
  const auto roi = [&](const std::string& rows) {
    return std::vector<std::string>{"--roi", folder.write("roi.csv", "ring,x,y\n" + rows)};
  };
  expect_refused(run(roi("0,10,10\n0,50,50\n0,50,10\n0,10,50\n")), 3, {"roi.csv"});
  expect_refused(run(roi("0,10,10\n0,50,50\n")), 3, {"roi.csv"});
  expect_refused(run(roi("0,10,10\n0,20,20\n0,30,30\n")), 3, {"roi.csv"});
  expect_refused(run(roi("0,100,100\n0,150,100\n0,150,150\n")), 3,
                 {"roi.csv", "outside the fixed image"});
  expect_refused(run(roi("0,10,ten\n")), 3, {"roi.csv", "2"});
  const auto partly = run(roi("0,31.5,10\n0,95.5,10\n0,95.5,50\n0,31.5,50\n"));
  EXPECT_EQ(partly.code, 0) << partly.err;
  EXPECT_THAT(testing::read_result(output())["warnings"].dump(), HasSubstr("50.0 %"));
}

TEST_F(RegisterBadInput, ImageThatIsConstant) {
  const std::string flat = save("flat.mha", plain(64));
  for (const char* transform : {"triangular-bspline", "bspline", "rigid"}) {
    std::vector<std::string> extra = {"--transform", transform};
    expect_refused(run_with(flat, image("moving.mha"), extra), 3,
                   {"the fixed image is constant (1)"});
    expect_refused(run_with(image("fixed.mha"), flat, extra), 3,
                   {"the moving image is constant (1)"});
  }
}

TEST_F(RegisterBadInput, ImageThatIsConstantInItsMask) {
  auto half = read_image<2>(image("fixed.mha")).image;
  Mask<2> mask(half.raster(), 0);
  for (int j = 0; j < 20; ++j) {
    for (int i = 0; i < 64; ++i) half(i, j) = mask(i, j) = 1;
  }
  write_mask(folder / "mask.mha", mask);
  expect_refused(run_with(save("half.mha", half), image("moving.mha"),
                          {"--fixed-mask", (folder / "mask.mha").string()}),
                 3, {"the fixed image is constant (1) inside its mask"});
}

TEST_F(RegisterBadInput, MaskBesideItsImage) {
  Raster<2> raster = plain(64).raster();
  raster.origin = {500, 0};
  write_mask(folder / "beside.mha", Mask<2>(raster, 1));
  const std::string file = (folder / "beside.mha").string();
  expect_refused(run({"--fixed-mask", file}), 3, {"mask of the fixed image is empty"});
  expect_refused(run({"--moving-mask", file}), 3, {"mask of the moving image is empty"});
}

TEST_F(RegisterBadInput, MaskThatIsEmpty) {
  write_mask(folder / "empty.mha", Mask<2>(plain(64).raster(), 0));
  expect_refused(run({"--fixed-mask", (folder / "empty.mha").string()}), 3,
                 {"--fixed-mask", "empty.mha", "empty"});
  expect_refused(run({"--moving-mask", (folder / "empty.mha").string()}), 3,
                 {"--moving-mask", "empty.mha", "empty"});
}

TEST_F(RegisterBadInput, Labels) {
  write_labels(folder / "none.mha", LabelImage<2>(plain(64).raster(), 0));
  expect_refused(run({"--rigid-labels", (folder / "none.mha").string()}), 3,
                 {"--rigid-labels", "none.mha", "no label above 0"});
  expect_refused(run({"--rigid-labels", image("fixed.mha")}), 3, {"fixed.mha"});  // not whole
}

TEST_F(RegisterBadInput, OutputThatCannotBe) {
  const std::string file = folder.write("out", "a file");
  const auto refused = run();
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--output"));
  EXPECT_EQ(testing::read_text(file), "a file");
}

TEST_F(RegisterBadInput, StartThatIsASpline) {
  ASSERT_EQ(run({"--levels", "1"}).code, 0);
  const std::string spline = (folder / "spline.json").string();
  std::filesystem::rename(folder / "out/transform.json", spline);
  std::filesystem::remove_all(folder / "out");
  expect_refused(run({"--init", spline}), 3, {"spline.json", "rigid or affine"});
}

// --init FILE is where a search starts, too.
TEST_F(RegisterBadInput, SearchStartsFromTheFileGiven) {
  const auto fixed = read_image<2>(image("fixed.mha")).image;
  Raster<2> raster = fixed.raster();
  raster.origin = {300, 0};
  const std::string moved = save("moved.mha", Image<float, 2>(raster, fixed.values()));
  AffineMap<2> near;
  near.offset = {298, 1};
  save_transform(AffineTransform<2>(near), folder / "near.json");
  const std::string of_itk = folder.write(
      "near.tfm",
      "#Insight Transform File V1.0\nTransform: CompositeTransform_double_2_2\nTransform: "
      "TranslationTransform_double_2_2\nParameters: 200 1\nTransform: "
      "Euler2DTransform_double_2_2\nParameters: 0 98 0\nFixedParameters: 9 9\n");
  for (const std::string& start : {(folder / "near.json").string(), of_itk}) {
    ASSERT_EQ(run_with(image("fixed.mha"), moved, {"--init", start, "--transform", "rigid"}).code,
              0);
    const auto found = load_transform<2>(folder / "out/transform.json");
    EXPECT_LT((found->map({30, 30}) - Point<2>(330, 30)).norm(), 0.02);  // pixel
  }
  const auto result = testing::read_result(output());
  EXPECT_TRUE(result["ncc"]["before"].is_null());  // without a start they do not overlap
  EXPECT_GT(result["ncc"]["after"], 0.99);
}

TEST_F(RegisterBadInput, IdenticalImagesAreNoError) {
  const auto same = run_with(image("fixed.mha"), image("fixed.mha"), {});
  EXPECT_EQ(same.code, 0) << same.err;
  const auto result = testing::read_result(output());
  EXPECT_EQ(result["status"], "ok");
  EXPECT_FALSE(result["improved"].get<bool>());
  EXPECT_FALSE(result["warnings"].empty());
  double largest = 0;  // spec: stays at the identity to 1e-6 pixel
  const auto field = read_displacement_field<2>(folder / "out/displacement.mha");
  for (const auto& u : field.values()) {
    largest = std::max(largest, u.norm());
  }
  EXPECT_LT(largest, 1e-6);
}

// Nine landmarks that are mirrored determine the nine control points of one biquadratic span.
TEST_F(RegisterBadInput, FoldingIsAWarningOrAFailedGate) {
  std::string pairs = "fixed_x,fixed_y,moving_x,moving_y\n";
  for (int x : {16, 32, 48}) {
    for (int y : {16, 32, 48}) pairs += message(x, ",", y, ",", 64 - x, ",", y, "\n");
  }
  const std::string file = folder.write("mirror.csv", pairs);
  const std::vector<std::string> extra = {"--metric",    "none",    "--landmarks", file,
                                          "--transform", "bspline", "--degree",    "2",
                                          "--gamma",     "0.1",     "--mesh-size", "64"};
  ASSERT_EQ(run(extra).code, 0);
  auto result = testing::read_result(output());
  EXPECT_GT(result["jacobian"]["folded_fraction"].get<double>(), 0);
  EXPECT_LE(result["jacobian"]["min"].get<double>(), 0);
  EXPECT_FALSE(result["jacobian"]["certified_positive"].get<bool>());
  EXPECT_THAT(result["warnings"].dump(), AllOf(HasSubstr("folds at"), HasSubstr("near (")));
  auto gate = extra;
  gate.emplace_back("--require-invertible");
  EXPECT_EQ(run(gate).code, 1);
  result = testing::read_result(output());
  EXPECT_EQ(result["status"], "gate_failed");
  EXPECT_THAT(result["warnings"].dump(), HasSubstr("no invertible map was found"));
  EXPECT_EQ(result["jacobian"]["certificate"]["verdict"], "folded");
  EXPECT_LE(result["jacobian"]["certificate"]["failing_region"]["determinant"], 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/displacement.mha"));
}

// Landmarks that come close fold the smoothest map between them.
TEST_F(RegisterBadInput, FoldingGivesWayWhereAnInvertibleMapIsAskedFor) {
  const std::string file = folder.write("squeeze.csv",
                                        "fixed_x,fixed_y,moving_x,moving_y\n"
                                        "24,32,31.7,32\n40,32,32.3,32\n13,32,13,32\n51,32,51,32\n");
  std::vector<std::string> extra = {"--metric",    "none",    "--landmarks", file,
                                    "--transform", "bspline", "--mesh-size", "8"};
  ASSERT_EQ(run(extra).code, 0);
  EXPECT_FALSE(testing::read_result(output())["jacobian"]["certified_positive"].get<bool>());
  extra.emplace_back("--require-invertible");
  const auto done = run(extra);
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("certified everywhere in the domain"));
  const auto result = testing::read_result(output());
  EXPECT_EQ(result["status"], "ok");
  EXPECT_TRUE(result["jacobian"]["certified_positive"].get<bool>());
  EXPECT_GT(result["jacobian"]["certificate"]["lower_bound"], 0);
  EXPECT_TRUE(result["jacobian"]["certificate"]["failing_region"].is_null());
  EXPECT_GT(result["unfolding"]["rounds"], 0);
  EXPECT_LT(result["landmarks"]["max_error_mm"], 1e-9);
  const auto info = testing::run_crease({"info", (folder / "out/transform.json").string()});
  EXPECT_THAT(info.out, HasSubstr("certified everywhere"));
}

}  // namespace
}  // namespace crease
