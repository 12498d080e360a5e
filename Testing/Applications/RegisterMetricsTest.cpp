// `crease register --metric`: each one by name, on images that it is made for.
#include <cmath>

#include "Testing/Applications/RegisterFixture.h"

namespace crease {
namespace {

constexpr double kLargestError = 0.6;  // mm, on average; the motion's is 1.24

class RegisterMetrics : public testing::RegisterFixture {
 protected:
  /// The moving image with other intensities.
  std::string changed(float (*scanner)(float)) const {
    auto moving = read_image<2>(image("moving.mha")).image;
    for (float& v : moving.values()) v = scanner(v);
    write_image(folder / "changed.mha", moving, PixelType::kFloat);
    return (folder / "changed.mha").string();
  }
  double mean_error() const {
    const auto run =
        testing::run_crease({"evaluate", "--displacement", output() + "/displacement.mha",
                             "--truth", image("truth.mha"), "--json", "--quiet"});
    EXPECT_EQ(run.code, 0) << run.err;
    return nlohmann::json::parse(run.out)["error_mm"]["mean"];
  }
};

}  // namespace

TEST_F(RegisterMetrics, EachIsKnownByNameAndReported) {
  for (const std::string metric : {"ssd", "ncc", "lncc", "mi", "nmi"}) {
    const auto result = registered({"--metric", metric, "--gamma", "0.01"});
    EXPECT_EQ(result["metric"]["name"], metric);
    EXPECT_LT(result["metric"]["after"], result["metric"]["before"]) << metric;
    EXPECT_LT(mean_error(), kLargestError) << metric;
  }
}

TEST_F(RegisterMetrics, SuitImagesOfOtherKinds) {
  const std::string negative = changed([](float v) { return 5 - 2 * v; });
  for (const std::string metric : {"lncc", "mi", "nmi"}) {
    const auto run =
        run_with(image("fixed.mha"), negative, {"--metric", metric, "--gamma", "0.01"});
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_LT(mean_error(), kLargestError) << metric;
  }
  const std::string gain = changed([](float v) { return 100 * v - 7; });
  EXPECT_EQ(run_with(image("fixed.mha"), gain, {"--metric", "ncc"}).code, 0);
  EXPECT_LT(mean_error(), kLargestError);
}

TEST_F(RegisterMetrics, RigidAndAffineSearchesTakeThem) {
  for (const std::string transform : {"rigid", "affine"}) {
    const auto run = run_with(image("fixed.mha"), changed([](float v) { return 5 - 2 * v; }),
                              {"--transform", transform, "--metric", "mi"});
    EXPECT_EQ(run.code, 0) << run.err;
    const auto result = testing::read_result(output());
    EXPECT_LT(result["metric"]["after"], result["metric"]["before"]);
  }
}

TEST_F(RegisterMetrics, RefuseWhatHasNoContrast) {
  expect_refused(
      run_with(image("fixed.mha"), changed([](float) { return 1.0f; }), {"--metric", "mi"}), 3,
      {"the moving image is constant"});
  expect_refused(run({"--metric", "correlation"}), 2, {"--metric", "\"correlation\" is unknown"});
}

}  // namespace crease
