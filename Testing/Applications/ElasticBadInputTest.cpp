// What `crease elastic` says about options and data that cannot be right.
#include "Testing/Applications/ElasticFixture.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class ElasticBadInput : public testing::ElasticFixture {};

TEST_F(ElasticBadInput, UnknownOptionsNameTheNearest) {
  expect_refused(run({"--materials", "x"}), 2, {"--materials", "--material"});
  expect_refused(run({"--refinment", "damped"}), 2, {"--refinement"});
}

TEST_F(ElasticBadInput, OptionsOutOfRange) {
  expect_refused(run({"--steps", "none"}), 2, {"--steps none", "adaptive"});
  expect_refused(run({"--steps", "0"}), 2, {"--steps 0"});
  expect_refused(run({"--plane", "shell"}), 2, {"--plane", "strain"});
  expect_refused(run({"--degree", "4"}), 2, {"--degree"});
  expect_refused(run({"--alpha", "1", "--alpha-relative", "2"}), 2, {"alpha"});
  expect_refused(run({"--damped-step", "0.1"}), 2, {"--refinement damped"});
  expect_refused(run({"--no-refine", "--metric", "mi"}), 2, {"--no-refine"});
  expect_refused(run({"--no-refine", "--levels", "2"}), 2, {"--levels", "--no-refine"});
  expect_refused(run({"--no-refine", "--smoothing", "1"}), 2, {"--smoothing", "--no-refine"});
  expect_refused(run({"--mirror", "yes"}), 2, {"--mirror", "mammograms"});
  expect_refused(run({"--threshold", "7"}), 2, {"--threshold", "mammograms"});
  expect_refused(run({"--corrector", "none", "--steps", "adaptive"}), 2, {"--corrector newton"});
}

TEST_F(ElasticBadInput, MaterialsThatCannotBe) {
  expect_refused(run({"--young", "soft"}), 2, {"--young", "LABEL=E"});
  expect_refused(run({"--poisson", "0.6"}), 2, {"--poisson", "0.6"});
  expect_refused(run({"--young", "-3"}), 2, {"--young", "-3"});
  expect_refused(run({"--poisson", "0.4995", "--plane", "strain"}), 2, {"--poisson"});
  expect_refused(run({"--poisson", "0.3,1=0.6"}), 2, {"region 1", "0.6", "(-1, 0.5)"});
  expect_refused(run({"--young", "0"}), 2, {"E = 0", "not a positive number"});
  expect_refused(run({"--regions", file("labels.mha"), "--young", "7=1000"}), 3,
                 {"region 7", "the regions 0 and 1 only"});
}

TEST_F(ElasticBadInput, PairsThatCannotBeMet) {
  expect_refused(run({"--pairs", pairs("10,10,11,11\n")}), 3, {"float"});
  expect_refused(run({"--pairs", pairs("10,10,11,11\n40,30,41,31\n70,30,60,31\n")}), 3,
                 {"6.5", "outside"});
  expect_refused(run({"--pairs", pairs("10,10,nan,11\n")}), 3, {"pairs.csv", "nan"});
  expect_refused(run({"--pairs", (folder / "none.csv").string()}), 3, {"none.csv"});
  expect_refused(run({"--contour-pairs", "2"}), 2, {"--contour-pairs 2"});
}

TEST_F(ElasticBadInput, RegionsWithoutLabels) {
  Raster<2> raster;
  raster.size = {8, 8};
  write_image(folder / "empty.mha", LabelImage<2>(raster), PixelType::kUint8);
  expect_refused(run({"--regions", (folder / "empty.mha").string()}), 3,
                 {"--regions", "no label above 0"});
}

TEST_F(ElasticBadInput, ImagesWithoutABreast) {
  expect_refused(run({"--roi", "auto"}), 3, {"fixed.mha"});
}

// Half of the body is to be pulled through the other half.
TEST_F(ElasticBadInput, NoEquilibriumWritesTheLastState) {
  const auto run = this->run({"--pairs",
                              pairs("10,10,10,10\n50,10,50,10\n10,50,10,50\n50,50,50,50\n"
                                    "30,30,58,58\n31,29,2,2\n"),
                              "--steps", "1"});
  EXPECT_EQ(run.code, 5) << run.err;
  EXPECT_THAT(run.err,
              AllOf(StartsWith("crease elastic: no elastic equilibrium beyond load fraction 0."),
                    ContainsRegex("(at|near) \\([0-9.]+, [0-9.]+\\) mm"),
                    HasSubstr("More pairs there, plane stress or neo-Hookean"),
                    HasSubstr("last equilibrium on the way")));
  EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
  const auto result = testing::read_result(output());
  EXPECT_EQ(result["status"], "not_converged");
  EXPECT_EQ(result["equilibrium"], false);
  EXPECT_LT(result["load_fraction"], 1);
  EXPECT_THAT(result["warnings"].dump(), HasSubstr("no elastic equilibrium"));
  EXPECT_TRUE(result["refinement"].is_null());
  EXPECT_TRUE(std::filesystem::exists(folder / "out/transform.json"));
}

// The images weigh so much that the damped iteration diverges, less and then more than halving can mend.
TEST_F(ElasticBadInput, DampedStepsAreHalvedOrGivenUp) {
  const auto damped = [&](const char* alpha) {
    return run({"--refinement", "damped", "--damped-step", "1", "--levels", "1", "--smoothing", "1",
                "--alpha-relative", alpha});
  };
  const auto halved = result_of(damped("0.1"));
  EXPECT_GT(halved["refinement"][0]["halvings"], 0);
  EXPECT_THAT(halved["warnings"].dump(),
              AllOf(HasSubstr("J grew with a damped step of 1"), HasSubstr("lowered to")));
  const auto given_up = damped("1e4");
  EXPECT_EQ(given_up.code, 5);
  EXPECT_THAT(given_up.err,
              AllOf(HasSubstr("halved 10 times"), HasSubstr("lower the weight of the images"),
                    HasSubstr("what the pairs do, not refined")));
  const auto result = testing::read_result(output());
  EXPECT_EQ(result["status"], "not_converged");
  EXPECT_EQ(result["equilibrium"], true);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/transform.json"));
}

}  // namespace
}  // namespace crease
