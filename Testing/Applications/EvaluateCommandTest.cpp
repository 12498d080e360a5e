#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "Images/ImageFile.h"
#include "Registration/Phantoms/Phantom.h"
#include "Testing/Applications/CommandRunner.h"
#include "Testing/TemporaryFolder.h"
#include "Transforms/RigidTransform.h"
#include "Transforms/TransformFile.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using testing::run_crease;

/// A phantom with bodies on disk.
class EvaluateCommand : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<testing::TemporaryFolder>();
    ASSERT_EQ(
        run_crease({"phantom", "bodies", "--size", "128", "-o", folder_->path().string()}).code, 0);
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::string file(const std::string& name) { return (*folder_ / name).string(); }
  static nlohmann::json evaluate(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "evaluate");
    arguments.insert(arguments.end(), {"--json", "--quiet"});
    const auto run = run_crease(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return nlohmann::json::parse(run.out);
  }
  static inline std::unique_ptr<testing::TemporaryFolder> folder_;
};

TEST_F(EvaluateCommand, TheTruthItselfIsRightEverywhere) {
  const auto json = evaluate({"--displacement", file("truth.mha"), "--truth", file("truth.mha"),
                              "--labels", file("labels.mha"), "--moving-labels",
                              file("moving-labels.mha"), "--landmarks", file("landmarks.csv"),
                              "--fixed", file("fixed.mha"), "--moving", file("moving.mha")});
  EXPECT_EQ(json["error_mm"]["max"], 0);
  EXPECT_LT(json["landmarks_mm"]["max"], 0.4);  // the field is read linearly, across creases too
  ASSERT_EQ(json["bodies"].size(), 3u);
  EXPECT_NEAR(std::abs(json["bodies"][0]["angle_deg"].get<double>()), 12, 0.01);
  for (const auto& body : json["bodies"]) EXPECT_LT(body["rms_nonrigidity_mm"], 0.01);
  ASSERT_EQ(json["labels"].size(), 3u);
  for (const auto& label : json["labels"]) EXPECT_GT(label["dice"], 0.95);
  EXPECT_GT(json["ssd_reduction_percent"], 95.0);
  EXPECT_GT(json["ncc"]["after"], 0.99);
}

TEST_F(EvaluateCommand, MeasuresTheErrorOfATransform) {
  RigidTransform<2> shift;
  shift.set_parameters(Eigen::Vector3d(0, 3, 4));
  const std::string transform = file("shift.json");
  save_transform(shift, transform);
  const auto truth = read_displacement_field<2>(file("truth.mha"));
  DisplacementField<2> zero(truth.raster(), Vector<2>::Zero());
  write_displacement_field(file("zero.mha"), zero);
  const auto json = evaluate({"--transform", transform, "--truth", file("zero.mha")});
  EXPECT_NEAR(json["error_mm"]["mean"].get<double>(), 5, 1e-12);
  EXPECT_NEAR(json["error_mm"]["max"].get<double>(), 5, 1e-12);
  EXPECT_EQ(json["jacobian"]["min"], 1);
  EXPECT_EQ(json["jacobian"]["folded_samples"], 0);
}

// A square of 20 pixels, in the moving image 3 mm to the right, and a map that stays: 17 of 20 columns overlap.
TEST_F(EvaluateCommand, MeasuresOverlapAndDistanceOfLabels) {
  Raster<2> raster;
  raster.size = {64, 48};
  const auto square = [&](int left) {
    LabelImage<2> labels(raster, 0);
    for (int j = 12; j < 32; ++j) {
      for (int i = left; i < left + 20; ++i) labels(i, j) = 7;
    }
    return labels;
  };
  write_labels(file("square.mha"), square(10));
  write_labels(file("moved.mha"), square(13));
  write_displacement_field(file("stay.mha"), DisplacementField<2>(raster, Vector<2>(0, 0)));
  const auto json = evaluate({"--displacement", file("stay.mha"), "--labels", file("square.mha"),
                              "--moving-labels", file("moved.mha")});
  ASSERT_EQ(json["labels"].size(), 1u);
  EXPECT_EQ(json["labels"][0]["label"], 7);
  EXPECT_DOUBLE_EQ(json["labels"][0]["dice"], 17.0 / 20);
  EXPECT_DOUBLE_EQ(json["labels"][0]["hausdorff_95_mm"], 3);
}

// Wrong by 2 mm within two pixels of the body's border, on both sides, and right elsewhere.
TEST_F(EvaluateCommand, MeasuresErrorsNearTheBordersOfBodies) {
  Raster<2> raster;
  raster.size = {80, 80};
  LabelImage<2> labels(raster, 0);
  DisplacementField<2> truth(raster, Vector<2>(1, 1)), found = truth;
  for (int j = 0; j < 80; ++j) {
    for (int i = 0; i < 80; ++i) {
      labels(i, j) = i >= 40 ? 1 : 0;
      if (i >= 38 && i < 42) found(i, j) += Vector<2>(2, 0);
    }
  }
  write_labels(file("half.mha"), labels);
  write_displacement_field(file("half-truth.mha"), truth);
  write_displacement_field(file("half-found.mha"), found);
  const auto json = evaluate({"--displacement", file("half-found.mha"), "--truth",
                              file("half-truth.mha"), "--labels", file("half.mha")});
  const double all = json["error_mm"]["mean"], three = json["error_within_3_px_mm"]["mean"],
               ten = json["error_within_10_px_mm"]["mean"];
  EXPECT_DOUBLE_EQ(all, 2.0 * 4 / 80);
  EXPECT_DOUBLE_EQ(three, 2.0 * 4 / 6);  // three columns on either side
  EXPECT_DOUBLE_EQ(ten, 2.0 * 4 / 20);
  EXPECT_EQ(json["error_within_3_px_mm"]["count"], 6 * 80);
  for (const char* statistic : {"mean", "median", "p95", "max"}) {
    EXPECT_TRUE(json["error_mm"].contains(statistic)) << statistic;
  }
  EXPECT_DOUBLE_EQ(json["bodies"][0]["error_mm"]["mean"], 2.0 * 2 / 40);
}

TEST_F(EvaluateCommand, CountsOnlyWhatTheMaskHolds) {
  Raster<2> raster;
  raster.size = {20, 10};
  DisplacementField<2> zero(raster, Vector<2>(0, 0)), half = zero;
  Mask<2> mask(raster, 0);
  for (int j = 0; j < 10; ++j) {
    for (int i = 0; i < 10; ++i) {
      half(i, j) = {0, 3};
      mask(i, j) = 1;
    }
  }
  write_displacement_field(file("mask-zero.mha"), zero);
  write_displacement_field(file("mask-half.mha"), half);
  write_mask(file("mask.mha"), mask);
  const auto json = evaluate({"--displacement", file("mask-half.mha"), "--truth",
                              file("mask-zero.mha"), "--mask", file("mask.mha")});
  EXPECT_EQ(json["samples"], 100);
  EXPECT_EQ(json["error_mm"]["mean"], 3);
}

TEST_F(EvaluateCommand, TellsFoldsAndImagesThatDidNotOverlapBefore) {
  Raster<2> raster;
  raster.size = {32, 32};
  Image<float, 2> image(raster);
  for (int j = 0; j < 32; ++j) {
    for (int i = 0; i < 32; ++i)
      image(i, j) = static_cast<float>(std::sin(0.4 * i) + std::cos(0.3 * j));
  }
  Raster<2> far = raster;
  far.origin = {100, 0};
  write_image(file("here.mha"), image, PixelType::kFloat);
  write_image(file("there.mha"), Image<float, 2>(far, image.values()), PixelType::kFloat);
  RigidTransform<2> shift;
  shift.set_parameters(Eigen::Vector3d(0, 100, 0));
  save_transform(shift, file("far.json"));
  const auto apart = evaluate({"--transform", file("far.json"), "--fixed", file("here.mha"),
                               "--moving", file("there.mha")});
  EXPECT_TRUE(apart["ssd"]["before"].is_null());
  EXPECT_TRUE(apart["ssd_reduction_percent"].is_null());
  EXPECT_NEAR(apart["ncc"]["after"].get<double>(), 1, 1e-6);

  DisplacementField<2> folded(raster, Vector<2>(0, 0));
  for (int j = 0; j < 32; ++j) folded(16, j) = {3, 0};  // leaps over its right neighbour
  write_displacement_field(file("folded.mha"), folded);
  const auto json = evaluate({"--displacement", file("folded.mha")});
  EXPECT_EQ(json["jacobian"]["folded_samples"], 32);
  EXPECT_DOUBLE_EQ(json["jacobian"]["min"], 1 - 3 / 2.0);
  EXPECT_DOUBLE_EQ(json["jacobian"]["max"], 1 + 3 / 2.0);
  EXPECT_THAT(json["warnings"].dump(), HasSubstr("folds at 32 of 1024 samples"));
}

TEST_F(EvaluateCommand, WritesAFolderOnRequestAndASummary) {
  const std::string output = file("evaluated");
  const auto run = run_crease({"evaluate", "--displacement", file("truth.mha"), "--labels",
                               file("labels.mha"), "--output", output, "--quiet"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("Jacobian"));
  EXPECT_THAT(run.out, HasSubstr("body 1"));
  EXPECT_EQ(testing::read_result(output)["command"], "evaluate");
}

TEST_F(EvaluateCommand, RefusesContradictions) {
  const auto refused = [](std::vector<std::string> arguments, int code, const char* text) {
    arguments.insert(arguments.begin(), "evaluate");
    const auto run = run_crease(arguments);
    EXPECT_EQ(run.code, code) << ::testing::PrintToString(arguments);
    EXPECT_THAT(run.err, HasSubstr(text));
  };
  const std::string truth = file("truth.mha");
  refused({}, 2, "nothing to evaluate");
  refused({"--displacement", truth, "--transform", "t.json"}, 2, "exclude each other");
  refused({"--displacement", truth, "--moving", file("moving.mha")}, 2, "--moving needs --fixed");
  refused({"--displacement", truth, "--fixed", file("fixed.mha")}, 2, "--fixed needs --moving");
  refused({"--displacement", truth, "--moving-labels", file("labels.mha")}, 2, "--labels");
  refused({"--transform", "t.json"}, 2, "needs a grid");
  refused({"--displacement", file("fixed.mha")}, 3, "fixed.mha");
  refused({"--displacement", "none.mha"}, 3, "none.mha");
}

}  // namespace
}  // namespace crease
