// Registration of elastic tissue through the command.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "Core/Error.h"
#include "Registration/Elastic/ElasticRegularization.h"
#include "Testing/Applications/RegisterFixture.h"

namespace crease {
namespace {

using testing::run_crease;

class RegisterElastic : public testing::RegisterFixture {};

/// Root mean square of the displacement's error, mm.
double error_of(const std::string& folder, const std::string& truth) {
  const auto run = run_crease({"evaluate", "--displacement", folder + "/displacement.mha",
                               "--truth", truth, "--json", "--quiet"});
  EXPECT_EQ(run.code, 0) << run.err;
  return nlohmann::json::parse(run.out)["error_mm"]["rms"];
}

// With the same automatic balance an elastic body is found about as well as one that resists bending.
TEST_F(RegisterElastic, FindsTheMotionOnTrianglesAndLattices) {
  for (const std::string transform : {"triangular-bspline", "bspline"}) {
    const auto bending = registered({"--transform", transform});
    const double of_bending = error_of(output(), image("truth.mha"));
    const auto elastic = registered({"--transform", transform, "--energy", "elastic"});
    const double of_elastic = error_of(output(), image("truth.mha"));
    EXPECT_GT(elastic["ssd_reduction_percent"],
              0.9 * bending["ssd_reduction_percent"].get<double>())
        << transform;
    EXPECT_LT(of_elastic, 1.5 * of_bending) << transform;
    EXPECT_TRUE(elastic["weights"].contains("elastic"));
    EXPECT_FALSE(elastic["weights"].contains("bending"));
    EXPECT_GT(elastic["energies"]["elastic"], 0.0);
    EXPECT_EQ(elastic["jacobian"]["folded_samples"], 0);
  }
}

// Only ratios of stiffness matter.
TEST_F(RegisterElastic, HasNoUnitOfStress) {
  registered({"--energy", "elastic"});
  const double once = error_of(output(), image("truth.mha"));
  registered({"--energy", "elastic", "--young", "5000"});
  EXPECT_NEAR(error_of(output(), image("truth.mha")), once, 1e-9 * once);
}

TEST(RegisterElasticPhantoms, TellsRegionsByLabels) {
  const testing::TemporaryFolder folder;
  const auto file = [&](const char* name) { return (folder / name).string(); };
  ASSERT_EQ(
      run_crease({"phantom", "square", "--size", "96", "-o", folder.path().string(), "--quiet"})
          .code,
      0);
  const auto run_with = [&](const std::string& young, const char* output) {
    return run_crease({"register", "--fixed", file("fixed.mha"), "--moving", file("moving.mha"),
                       "--rigid-labels", file("labels.mha"), "--beta", "0", "--energy", "elastic",
                       "--young", young, "--degree", "2", "--output", file(output), "--quiet"});
  };
  ASSERT_EQ(run_with("1,1=100", "stiff").code, 0);
  ASSERT_EQ(run_with("1", "soft").code, 0);
  const auto nonrigidity = [&](const char* output) -> double {
    return testing::read_result(folder / output)["bodies"][0]["rms_nonrigidity_mm"];
  };
  EXPECT_LT(nonrigidity("stiff"), 0.7 * nonrigidity("soft"));
  const auto refused = run_with("1,7=100", "none");
  EXPECT_EQ(refused.code, 3) << refused.err;
  EXPECT_THAT(refused.err, ::testing::HasSubstr("names region 7"));
}

// A step that would turn tissue inside out is taken back; it once ended the registration.
TEST_F(RegisterElastic, NeoHookeanTissueIsNotTurnedInsideOut) {
  const auto linear = registered({"--energy", "elastic"});
  const auto neo = registered({"--energy", "elastic", "--material", "neo-hookean"});
  EXPECT_GT(neo["jacobian"]["min"], 0.0);
  EXPECT_GT(neo["ssd_reduction_percent"], 0.8 * linear["ssd_reduction_percent"].get<double>());
}

// On a tensor lattice, by both laws, about as well as one that resists bending.
TEST(RegisterElasticVolumes, FindTheMotionOfABodyInSpace) {
  const testing::TemporaryFolder folder;
  const auto file = [&](const char* name) { return (folder / name).string(); };
  ASSERT_EQ(run_crease({"phantom", "blobs", "--dimension", "3", "--size", "24", "-o",
                        folder.path().string(), "--quiet"})
                .code,
            0);
  const auto register_with = [&](std::vector<std::string> extra, const char* output) {
    std::vector<std::string> arguments = {"register", "--fixed",          file("fixed.mha"),
                                          "--moving", file("moving.mha"), "--transform",
                                          "bspline",  "--mesh-size",      "6",
                                          "--output", file(output),       "--quiet"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    const auto run = run_crease(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return testing::read_result(folder / output);
  };
  const auto bending = register_with({"--energy", "bending"}, "bending");
  const auto result = register_with({"--energy", "elastic"}, "elastic");
  EXPECT_EQ(result["status"], "ok");
  EXPECT_GT(result["energies"]["elastic"], 0.0);
  EXPECT_GT(result["ssd_reduction_percent"], 0.7 * bending["ssd_reduction_percent"].get<double>());
  EXPECT_EQ(result["jacobian"]["folded_samples"], 0);
  const double of_bending = error_of(file("bending"), file("truth.mha"));
  const double of_elastic = error_of(file("elastic"), file("truth.mha"));
  EXPECT_LT(of_elastic, 1.5 * of_bending);
  const auto neo = register_with({"--energy", "elastic", "--material", "neo-hookean"}, "neo");
  EXPECT_GT(neo["jacobian"]["min"], 0.0);
  EXPECT_LT(error_of(file("neo"), file("truth.mha")), 1.5 * of_bending);
}

TEST(RegisterElasticOptions, MeanDilatationIsForLoadSteps) {
  EXPECT_EQ(run_crease({"register", "--mean-dilatation"}).code, 2);
  ElasticMaterial material;
  material.mean_dilatation = true;
  EXPECT_THROW(elastic<2>(material), InvalidInput);
}

}  // namespace
}  // namespace crease
