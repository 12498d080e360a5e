// What the user reads when input is bad: one message that names file and option, and the exit code.
#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "Testing/Applications/RegisterFixture.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class RegisterBadInput : public testing::RegisterFixture {
 protected:
  void expect_refused(const testing::CommandResult& run, int code,
                      const std::vector<std::string>& texts) const {
    EXPECT_EQ(run.code, code) << run.err;
    EXPECT_THAT(run.err, ::testing::StartsWith("crease register: "));
    for (const auto& text : texts) EXPECT_THAT(run.err, HasSubstr(text));
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "out/result.json"));
  }
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
  expect_refused(run_with((folder / "volume.mha").string(), (folder / "volume.mha").string(), {}),
                 2, {"--transform triangular-bspline works on 2D images", "volume.mha is 3D"});
}

TEST_F(RegisterBadInput, ImagesThatDoNotOverlap) {
  const auto far = read_image<2>(image("moving.mha")).image;
  Raster<2> raster = far.raster();
  raster.origin = {1000, 2000};
  write_image(folder / "far.mha", Image<float, 2>(raster, far.values()), PixelType::kFloat);
  expect_refused(run_with(image("fixed.mha"), (folder / "far.mha").string(), {}), 3,
                 {"do not overlap", "(-0.5, -0.5) to (63.5, 63.5)", "(999.5, 1999.5)"});
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

TEST_F(RegisterBadInput, FeatureLines) {
  const auto lines = [&](const std::string& rows) {
    return std::vector<std::string>{"--feature-lines",
                                    folder.write("lines.csv", "line,x,y\n" + rows)};
  };
  expect_refused(run(lines("1,10,10\n")), 3, {"lines.csv", "1"});
  expect_refused(run(lines("1,10,10\n1,nan,20\n")), 3, {"lines.csv", "3"});
  expect_refused(run(lines("1,200,200\n1,300,200\n")), 3, {"outside"});
  const auto clipped = run(lines("1,32,32\n1,100,34\n"));
  EXPECT_EQ(clipped.code, 0) << clipped.err;
}

TEST_F(RegisterBadInput, FeatureLinesOfLaterKinds) {
  for (const char* kind : {"slide", "slit"}) {
    const std::string file = folder.write(
        "lines.csv", std::string("line,x,y,kind\n1,10,10,") + kind + "\n1,50,50," + kind + "\n");
    expect_refused(run({"--feature-lines", file}), 3, {kind});
  }
}

TEST_F(RegisterBadInput, MeshThatWouldBeTooFine) {
  expect_refused(run({"--mesh-size", "0.01"}), 3, {"0.01", "triangles"});
}

TEST_F(RegisterBadInput, Landmarks) {
  const std::string header = "fixed_x,fixed_y,moving_x,moving_y\n";
  const auto landmarks = [&](const std::string& text) {
    return std::vector<std::string>{"--landmarks", folder.write("pairs.csv", text)};
  };
  expect_refused(run(landmarks(header + "10,10,11,11\n12,x,13,13\n")), 3, {"pairs.csv", "3"});
  expect_refused(run(landmarks(header + "10,10,11\n")), 3, {"pairs.csv", "2"});
  expect_refused(run(landmarks("fixed_x,fixed_y\n10,10\n")), 3, {"pairs.csv", "moving_x"});
  expect_refused(run(landmarks(header + "-20,30,11,11\n")), 3, {"landmark", "19.5"});
  expect_refused(run(landmarks(header + "20,30,21,31\n20,30,25,35\n")), 3, {"landmark"});
}

TEST_F(RegisterBadInput, LandmarksThatContradictEachOther) {
  // Sixty pairs within a few triangles, each moved at random: more than a cubic patch can meet.
  std::string text = "fixed_x,fixed_y,moving_x,moving_y\n";
  unsigned state = 7;
  const auto random = [&] { return (state = state * 1664525u + 1013904223u) / 4294967296.0; };
  for (int i = 0; i < 60; ++i) {
    const double x = 26 + 12 * random(), y = 26 + 12 * random();
    text += message(x, ",", y, ",", x + random(), ",", y + random(), "\n");
  }
  const std::string file = folder.write("pairs.csv", text);
  expect_refused(run({"--landmarks", file}), 3, {"landmark"});
}

TEST_F(RegisterBadInput, ImageThatIsConstant) {
  expect_refused(run_with(save("flat.mha", plain(64)), image("moving.mha"), {}), 3,
                 {"fixed image", "constant"});
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

TEST_F(RegisterBadInput, OptionsOutOfRange) {
  const auto refused = [&](const std::vector<std::string>& extra,
                           const std::vector<std::string>& texts) {
    expect_refused(run(extra), 2, texts);
  };
  refused({"--alpha", "-1"}, {"--alpha", "at least 0"});
  refused({"--gamma", "-0.1"}, {"--gamma", "at least 0"});
  refused({"--degree", "0"}, {"--degree", "1 to 5"});
  refused({"--degree", "6"}, {"--degree", "1 to 5"});
  refused({"--degree", "1"}, {"--degree 1", "--gamma 0"});
  refused({"--degree", "2", "--smoothness", "2"}, {"--smoothness 2", "--degree 3"});
  refused({"--levels", "0"}, {"--levels"});
  refused({"--triangles", "1"}, {"--triangles"});
  refused({"--alpha", "0", "--gamma", "0"}, {"all weights are zero", "--alpha", "--gamma"});
  refused({"--alpha", "0"}, {"--alpha 0", "--landmarks"});
  refused({"--metric", "none"}, {"--metric none", "--landmarks"});
  refused({"--beta", "2"}, {"--beta", "--rigid-labels"});
  refused({"--landmarks-mode", "soft"}, {"--landmarks-mode soft", "--landmarks FILE"});
  refused({"--init", "landmarks"}, {"--init landmarks", "--landmarks FILE"});
  refused({"--init", "moment"}, {"--init", "did you mean moments?"});
  refused({"--transform", "affine", "--mesh-size", "9"}, {"--mesh-size", "affine"});
  refused({"--transform", "bspline", "--triangles", "9"}, {"--triangles", "bspline"});
  refused({"--spacing", "1,1,1"}, {"--spacing"});
  refused({"--spacing", "2,2"}, {"--spacing", "tell their own"});
  refused({"--threads", "0"}, {"--threads"});
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
  expect_refused(run({"--init", spline}), 3, {"spline.json", "affine or rigid"});
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

TEST_F(RegisterBadInput, FoldingIsAWarningOrAFailedGate) {
  const std::string file = folder.write("swap.csv",
                                        "fixed_x,fixed_y,moving_x,moving_y\n"
                                        "26,32,40,32\n38,32,24,32\n2,2,2,2\n60,60,60,60\n");
  const std::vector<std::string> extra = {"--metric", "none", "--landmarks", file};
  ASSERT_EQ(run(extra).code, 0);
  auto result = testing::read_result(output());
  EXPECT_GT(result["jacobian"]["folded_fraction"].get<double>(), 0);
  EXPECT_LE(result["jacobian"]["min"].get<double>(), 0);
  EXPECT_THAT(result["warnings"].dump(), AllOf(HasSubstr("folds at"), HasSubstr("near (")));
  auto gate = extra;
  gate.push_back("--require-invertible");
  EXPECT_EQ(run(gate).code, 1);
  result = testing::read_result(output());
  EXPECT_EQ(result["status"], "gate_failed");
  EXPECT_TRUE(std::filesystem::exists(folder / "out/displacement.mha"));
}

}  // namespace
}  // namespace crease
