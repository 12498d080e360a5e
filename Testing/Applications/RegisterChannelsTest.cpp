// `crease register` with several pairs of images at once.
#include "Testing/Applications/RegisterFixture.h"

namespace crease {
namespace {

class RegisterChannels : public testing::RegisterFixture {
 protected:
  /// One of the phantom's images with other intensities.
  std::string changed(const std::string& name, const std::string& of,
                      float (*scanner)(float)) const {
    auto read = read_image<2>(image(of)).image;
    for (float& v : read.values()) v = scanner(v);
    write_image(folder / name, read, PixelType::kFloat);
    return (folder / name).string();
  }
  /// A second pair: another contrast of the fixed image, and its reverse of the moving one.
  std::vector<std::string> second() const {
    return {"--fixed", changed("fixed2.mha", "fixed.mha", [](float v) { return 30 * v * v; }),
            "--moving", changed("moving2.mha", "moving.mha", [](float v) { return 5 - 2 * v; })};
  }
  std::vector<std::string> with(std::vector<std::string> options,
                                const std::vector<std::string>& more) const {
    options.insert(options.end(), more.begin(), more.end());
    return options;
  }
};

}  // namespace

TEST_F(RegisterChannels, AreReportedAndWarpedEach) {
  const auto result = registered(
      with(second(), {"--metric", "ssd", "--metric", "mi", "--channel-weights", "1,0.25"}));
  const auto& metric = result["metric"];
  EXPECT_EQ(metric["name"], "ssd+mi");
  EXPECT_LT(metric["after"], metric["before"]);
  ASSERT_EQ(metric["channels"].size(), 2);
  EXPECT_EQ(metric["channels"][0]["name"], "ssd");
  EXPECT_EQ(metric["channels"][1]["name"], "mi");
  EXPECT_EQ(metric["channels"][0]["weight"], 1);
  EXPECT_EQ(metric["channels"][1]["weight"], 0.25);
  for (const auto& channel : metric["channels"]) EXPECT_LT(channel["after"], channel["before"]);
  EXPECT_EQ(result["inputs"].size(), 4);
  const auto one = read_image<2>(folder / "out/warped.mha").image;
  const auto two = read_image<2>(folder / "out/warped-2.mha").image;
  const auto at = std::array{30, 30};
  EXPECT_NEAR(two[at], 5 - 2 * one[at], 1e-4);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/warped-3.mha"));
  const std::string page = testing::read_text(folder / "out/report.html");
  for (const char* text : {"with 1 further channel", "warped, channel 2", "Channels, compared"}) {
    EXPECT_THAT(page, ::testing::HasSubstr(text));
  }

  // What is written down repeats the run.
  const auto again =
      testing::run_crease({"register", "--config", (folder / "out/config.toml").string(),
                           "--output", (folder / "again").string(), "--quiet"});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(testing::read_result(folder / "again")["metric"], metric);
}

TEST_F(RegisterChannels, ThoseOfAnEarlierRunAreRemoved) {
  registered(second());
  EXPECT_TRUE(std::filesystem::exists(folder / "out/warped-2.mha"));
  registered({});
  EXPECT_TRUE(std::filesystem::exists(folder / "out/warped.mha"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/warped-2.mha"));
}

TEST_F(RegisterChannels, OneIsListedToo) {
  for (const std::string transform : {"triangular-bspline", "rigid"}) {
    const auto metric = registered({"--transform", transform})["metric"];
    ASSERT_EQ(metric["channels"].size(), 1);
    EXPECT_EQ(metric["channels"][0]["before"], metric["before"]);
    EXPECT_EQ(metric["channels"][0]["after"], metric["after"]);
  }
}

TEST_F(RegisterChannels, ServeSearchesOneMetricForAllAndMasks) {
  const std::string mask = changed("mask.mha", "moving.mha", [](float) { return 1.0f; });
  for (const std::string transform : {"rigid", "affine", "bspline"}) {
    const auto metric = registered(with(
        second(), {"--transform", transform, "--metric", "mi", "--moving-mask", mask}))["metric"];
    EXPECT_EQ(metric["name"], "mi");
    EXPECT_EQ(metric["channels"].size(), 2);
    EXPECT_LT(metric["after"], metric["before"]) << transform;
  }
}

TEST_F(RegisterChannels, AreRefusedWhereTheyDoNotMatch) {
  const auto refused = [&](const std::vector<std::string>& extra, int code,
                           const std::vector<std::string>& texts) {
    expect_refused(run(extra), code, texts);
  };
  refused({"--fixed", image("fixed.mha")}, 2, {"--fixed is given 2 times, but --moving once"});
  refused(with(second(), {"--metric", "ssd", "--metric", "mi", "--metric", "ncc"}), 2,
          {"--metric is given 3 times for 2 channels"});
  refused({"--metric", "ssd", "--metric", "mi"}, 2, {"--metric is given 2 times for 1 channel;"});
  refused(with(second(), {"--metric", "ssd", "--metric", "none"}), 2, {"--metric none"});
  refused(with(second(), {"--channel-weights", "1"}), 2,
          {"--channel-weights has 1 for 2 channels"});
  refused(with(second(), {"--channel-weights", "1,-1"}), 2,
          {"--channel-weights", "\"-1\" is not a number of at least 0"});
  refused(with(second(), {"--channel-weights", "0,0"}), 2, {"--channel-weights are all zero"});
  refused({"--channel-weights", "2"}, 2, {"--alpha"});

  auto other = read_image<2>(image("fixed.mha")).image;
  Raster<2> raster = other.raster();
  raster.spacing = {2, 2};
  write_image(folder / "other.mha", Image<float, 2>(raster, other.values()), PixelType::kFloat);
  refused({"--fixed", (folder / "other.mha").string(), "--moving", image("moving.mha")}, 3,
          {"different grids", "fixed.mha has 64 x 64", "other.mha has 64 x 64", "2 x 2 mm"});
  refused({"--fixed", changed("flat.mha", "fixed.mha", [](float) { return 2.0f; }), "--moving",
           image("moving.mha")},
          3, {"the fixed image is constant"});
}

}  // namespace crease
