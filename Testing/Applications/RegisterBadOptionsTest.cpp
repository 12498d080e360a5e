// Options and configurations of `crease register` that are refused: exit code 2 and the option's name.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "Testing/Applications/RegisterFixture.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class RegisterBadOptions : public testing::RegisterFixture {};

TEST_F(RegisterBadOptions, OptionsOutOfRange) {
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
  refused({"--optimizer", "nelder-mead"}, {"--optimizer nelder-mead", "rigid", "gauss-newton"});
  refused({"--optimizer", "bfgs"}, {"--optimizer", "did you mean lbfgs?"});
  refused({"--sample-fraction", "0"}, {"--sample-fraction", "above 0"});
  refused({"--sample-fraction", "1.5"}, {"--sample-fraction", "1"});
  refused({"--transform", "rigid", "--sample-fraction", "0.5"}, {"--sample-fraction", "rigid"});
  refused({"--transform", "bspline", "--triangles", "9"}, {"--triangles", "bspline"});
  refused({"--spacing", "1,1,1"}, {"--spacing"});
  refused({"--spacing", "2,2"}, {"--spacing", "tell their own"});
  refused({"--threads", "0"}, {"--threads: \"0\" is not a whole number from 1 to 1024"});
  refused({"--seed", "-1"}, {"--seed", "at least 0"});
  refused({"--progress", "jsn"}, {"--progress", "did you mean json?"});
  refused({"--spacing", "1,zero"}, {"--spacing", "\"zero\" is not a number"});
  refused({"--landmarks", image("fixed.mha"), "--landmarks-sigma", "0"},
          {"--landmarks-sigma", "above 0"});
}

TEST_F(RegisterBadOptions, ElasticTissue) {
  const auto refused = [&](const std::vector<std::string>& extra,
                           const std::vector<std::string>& texts) {
    expect_refused(run(extra), 2, texts);
  };
  refused({"--energy", "elastc"}, {"--energy", "did you mean elastic?"});
  refused({"--young", "5"}, {"--young", "add --energy elastic"});
  refused({"--energy", "elastic", "--young", "-5"}, {"--young", "E = -5"});
  refused({"--energy", "elastic", "--young", "stiff"}, {"--young", "\"stiff\" is not a number"});
  refused({"--energy", "elastic", "--young", "1,bone=9"}, {"\"bone\" is not a region's label"});
  refused({"--energy", "elastic", "--poisson", "0.5"}, {"--poisson", "(-1, 0.5)"});
  refused({"--energy", "elastic", "--poisson", "0.4995", "--plane", "strain"}, {"plane strain"});
  refused({"--energy", "elastic", "--young", "1,2=9"}, {"region 2", "--rigid-labels"});
  refused({"--energy", "elastic", "--transform", "affine"}, {"--energy elastic", "affine"});
  refused({"--energy", "elastic", "--adapt", "1"}, {"--adapt", "bending"});
}

// Nothing of a later version is silently accepted.
TEST_F(RegisterBadOptions, OptionsOfLaterVersionsAreUnknown) {
  for (const char* option : {"--orientations", "--slide-labels"}) {
    expect_refused(run({option, "exact"}), 2,
                   {std::string("the option ") + option + " is unknown"});
  }
  for (const char* transform : {"demons", "syn"}) {
    expect_refused(run({"--transform", transform}), 2,
                   {std::string("--transform: \"") + transform + "\" is unknown", "It takes "});
  }
  for (const char* command : {"mammogram", "shell", "solid"}) {
    const auto refused = testing::run_crease({command, "--output", output()});
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.err, HasSubstr(std::string("\"") + command + "\" is not a subcommand"));
  }
  EXPECT_FALSE(std::filesystem::exists(output()));
}

TEST_F(RegisterBadOptions, MisspeltOptionsNameTheNearest) {
  expect_refused(run({"--landmark-mode", "soft"}), 2,
                 {"--landmark-mode", "did you mean --landmarks-mode?"});
  expect_refused(run({"--no-crease"}), 2, {"did you mean --no-creases?"});
  expect_refused(run({"--transform", "b-spline"}), 2, {"did you mean bspline?"});
  expect_refused(run({"--treads", "2"}), 2, {"did you mean --threads?"});
}

TEST_F(RegisterBadOptions, Configurations) {
  const auto with = [&](const std::string& text) {
    return std::vector<std::string>{"--config", folder.write("c.toml", text)};
  };
  expect_refused(run({"--config", (folder / "none.toml").string()}), 2,
                 {"none.toml", "cannot be read"});
  expect_refused(run({"--config", folder.path().string()}), 2, {"cannot be read"});
  expect_refused(run(with("[register]\nlandmark = \"l.csv\"\n")), 2,
                 {"c.toml, line 2", "the key landmark is unknown", "did you mean landmarks?"});
  expect_refused(run(with("[registr]\n")), 2, {"c.toml, line 1", "did you mean [register]?"});
  expect_refused(run(with("[register]\nalpha = \n")), 2, {"c.toml, line 2"});
  expect_refused(run(with("[register]\nthreads = 0\n")), 2,
                 {"c.toml, line 2: threads", "1 to 1024"});
  expect_refused(run(with("[register]\nmetric = \"sad\"\n")), 2,
                 {"line 2: metric: \"sad\" is unknown"});
  // Sections of other subcommands are passed over.
  EXPECT_EQ(run(with("[warp]\ninverse = true\n[register]\nlevels = 1\n")).code, 0);
}

TEST_F(RegisterBadOptions, VolumesNeedAnotherTransform) {
  Raster<3> raster;
  raster.size = {8, 8, 8};
  write_image(folder / "volume.mha", Image<float, 3>(raster), PixelType::kFloat);
  const std::string volume = (folder / "volume.mha").string();
  expect_refused(run_with(volume, volume, {}), 2,
                 {"--transform triangular-bspline works on 2D images", "volume.mha is 3D",
                  "take bspline, affine or rigid"});
}

}  // namespace
}  // namespace crease
