// The main job, end to end through the command: phantoms with rigid bodies, and real images if they are
// there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "Images/ImageFile.h"
#include "Registration/Landmarks.h"
#include "Testing/Applications/CommandRunner.h"
#include "Testing/TemporaryFolder.h"

namespace crease {
namespace {

using testing::read_result;
using testing::run_crease;
using testing::TemporaryFolder;

/// Makes a phantom, registers it with creases from its labels and exact landmarks, and evaluates.
nlohmann::json register_phantom(const TemporaryFolder& folder, const std::string& kind,
                                const std::vector<std::string>& extra = {}) {
  const auto file = [&](const char* name) { return (folder / name).string(); };
  EXPECT_EQ(run_crease({"phantom", kind, "-o", folder.path().string(), "--quiet"}).code, 0);
  std::vector<std::string> arguments = {
      "register",         "--fixed",          file("fixed.mha"),
      "--moving",         file("moving.mha"), "--rigid-labels",
      file("labels.mha"), "--landmarks",      file("landmarks.csv"),
      "--output",         file("out"),        "--quiet"};
  arguments.insert(arguments.end(), extra.begin(), extra.end());
  const auto run = run_crease(arguments);
  EXPECT_EQ(run.code, 0) << run.err;
  const auto evaluation =
      run_crease({"evaluate", "--displacement", file("out/displacement.mha"), "--truth",
                  file("truth.mha"), "--labels", file("labels.mha"), "--json", "--quiet"});
  EXPECT_EQ(evaluation.code, 0) << evaluation.err;
  return nlohmann::json::parse(evaluation.out);
}

TEST(RegisterPhantoms, SpineBodiesMoveRigidly) {
  const TemporaryFolder folder;
  const auto evaluation = register_phantom(folder, "spine");
  const auto result = read_result(folder / "out");
  EXPECT_LT(result["landmarks"]["max_error_mm"], 512e-9);
  EXPECT_EQ(result["jacobian"]["folded_samples"], 0);
  EXPECT_GT(result["ssd_reduction_percent"], 90.0);
  ASSERT_EQ(evaluation["bodies"].size(), 5u);
  for (const auto& body : evaluation["bodies"]) {
    EXPECT_LT(body["error_mm"]["rms"], 0.25) << body.dump();
    EXPECT_LT(std::abs(body["angle_error_deg"].get<double>()), 0.3) << body.dump();
  }
}

TEST(RegisterPhantoms, ThreeBodiesMoveRigidlyOnTheirOwn) {
  const TemporaryFolder folder;
  const auto evaluation = register_phantom(folder, "bodies");
  const auto result = read_result(folder / "out");
  EXPECT_LT(result["landmarks"]["max_error_mm"], 400e-9);
  EXPECT_EQ(result["jacobian"]["folded_samples"], 0);
  ASSERT_EQ(evaluation["bodies"].size(), 3u);
  for (const auto& body : evaluation["bodies"]) {
    EXPECT_LT(body["error_mm"]["rms"], 0.25) << body.dump();
    EXPECT_LT(std::abs(body["angle_error_deg"].get<double>()), 0.3) << body.dump();
  }
}

TEST(RegisterPhantoms, SquareIsTurnedByItsLandmarksAlone) {
  const TemporaryFolder folder;
  const auto evaluation = register_phantom(folder, "square", {"--metric", "none", "--gamma", "1"});
  const auto result = read_result(folder / "out");
  EXPECT_LT(result["landmarks"]["max_error_mm"], 400e-9);
  EXPECT_NEAR(std::abs(evaluation["bodies"][0]["angle_deg"].get<double>()), 45, 0.5);
}

// The fixed slice is 13 mm to the left of and 17 mm above the moving one.
TEST(RegisterRealImages, BrainSliceShiftedBy13And17) {
  const std::string fixed = testing::shared_file("images2d/BrainProtonDensitySliceBorder20.png");
  const std::string moving =
      testing::shared_file("images2d/BrainProtonDensitySliceShifted13x17y.png");
  if (fixed.empty() || moving.empty()) GTEST_SKIP() << "the brain slices are not there";
  const TemporaryFolder folder;
  for (const char* transform : {"rigid", "triangular-bspline"}) {
    const auto run = run_crease({"register", "--fixed", fixed, "--moving", moving, "--transform",
                                 transform, "--output", (folder / "out").string(), "--quiet"});
    ASSERT_EQ(run.code, 0) << run.err;
    const auto image = read_image<2>(fixed).image;
    const auto field = read_displacement_field<2>(folder / "out/displacement.mha");
    Vector<2> sum = Vector<2>::Zero();
    int count = 0;
    for (int j = 0; j < image.size()[1]; ++j) {
      for (int i = 0; i < image.size()[0]; ++i) {
        if (image(i, j) < 20) continue;  // air
        sum += field(i, j);
        ++count;
      }
    }
    EXPECT_LT((sum / count - Vector<2>(13, 17)).norm(), 0.1) << transform;
  }
}

}  // namespace
}  // namespace crease
