#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "Images/ImageFile.h"
#include "Registration/Phantoms/Phantom.h"
#include "Testing/Applications/CommandRunner.h"
#include "Testing/Applications/TemporaryFolder.h"
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
