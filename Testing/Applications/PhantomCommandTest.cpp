#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "Images/ImageFile.h"
#include "Registration/Landmarks.h"
#include "Testing/Applications/CommandRunner.h"
#include "Testing/TemporaryFolder.h"
#include "Transforms/Domains/FeatureLineFile.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using testing::read_result;
using testing::run_crease;
using testing::TemporaryFolder;

TEST(PhantomCommand, WritesWhatItsKindHas) {
  const TemporaryFolder folder;
  const auto run = run_crease({"phantom", "bodies", "--size", "96", "-o", folder.path().string()});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("bodies: 96 x 96 pixels, 3 bodies, 13 landmarks"));
  const auto fixed = read_image<2>(folder / "fixed.mha");
  EXPECT_EQ(fixed.image.size(), (std::array<int, 2>{96, 96}));
  EXPECT_EQ(fixed.image.raster().spacing, Vector<2>(1, 1));
  EXPECT_EQ(read_image<2>(folder / "moving.mha").image.size(), fixed.image.size());
  EXPECT_EQ(read_displacement_field<2>(folder / "truth.mha").size(), fixed.image.size());
  EXPECT_EQ(read_labels<2>(folder / "labels.mha").size(), fixed.image.size());
  EXPECT_EQ(read_labels<2>(folder / "moving-labels.mha").size(), fixed.image.size());
  EXPECT_EQ(read_landmarks<2>(folder / "landmarks.csv").size(), 13);
  EXPECT_EQ(read_feature_lines(folder / "feature-lines.csv").size(), 3u);
  const auto phantom = nlohmann::json::parse(testing::read_text(folder / "phantom.json"));
  EXPECT_EQ(phantom["kind"], "bodies");
  ASSERT_EQ(phantom["bodies"].size(), 3u);
  EXPECT_NEAR(phantom["bodies"][0]["angle_deg"].get<double>(), 12, 1e-12);
  const auto result = read_result(folder.path());
  EXPECT_EQ(result["command"], "phantom");
  EXPECT_EQ(result["status"], "ok");
  EXPECT_TRUE(std::filesystem::exists(folder / "config.toml"));
}

TEST(PhantomCommand, BlobsHaveNeitherBodiesNorLandmarks) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_crease({"phantom", "blobs", "--size", "64", "-o", folder.path().string()}).code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "truth.mha"));
  for (const char* name : {"labels.mha", "landmarks.csv", "feature-lines.csv"}) {
    EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
  }
}

TEST(PhantomCommand, BlobsHaveVolumes) {
  const TemporaryFolder folder;
  const auto run = run_crease({"phantom", "blobs", "--dimension", "3", "--size", "20",
                               "--no-texture", "-o", folder.path().string()});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out, "blobs: 20 x 20 x 20 voxels, in " + folder.path().string() + "\n");
  EXPECT_EQ(read_image<3>(folder / "fixed.mha").image.size(), (std::array<int, 3>{20, 20, 20}));
  EXPECT_EQ(read_displacement_field<3>(folder / "truth.mha").size(),
            (std::array<int, 3>{20, 20, 20}));
}

TEST(PhantomCommand, MammogramsComeWithAllThatIsKnown) {
  const TemporaryFolder folder;
  const auto run = run_crease({"phantom", "mammogram", "--size", "256", "--bits", "8", "--mass",
                               "moving", "-o", folder.path().string()});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("mammogram: 256 x 256 pixels, "));
  const auto fixed = read_image<2>(folder / "fixed.mha");
  EXPECT_EQ(fixed.pixel_type, PixelType::kUint8);
  EXPECT_EQ(fixed.image.size(), (std::array<int, 2>{256, 256}));
  EXPECT_LT((fixed.image.raster().spacing - Vector<2>(0.8, 0.8)).norm(), 1e-12);
  for (const std::string prefix : {"", "moving-"}) {
    EXPECT_EQ(read_mask<2>(folder / (prefix + "mask.mha")).size(), fixed.image.size());
    EXPECT_EQ(read_labels<2>(folder / (prefix + "labels.mha")).size(), fixed.image.size());
    EXPECT_GT(read_feature_lines(folder / (prefix + "outline.csv")).at(0).points.size(), 3000u);
    const auto pectoral = read_feature_lines(folder / (prefix + "feature-lines.csv"));
    ASSERT_EQ(pectoral.size(), 1u);
    EXPECT_EQ(pectoral[0].kind, FeatureKind::kCrease);
    EXPECT_FALSE(pectoral[0].closed);
    const std::string marks = testing::read_text(folder / (prefix + "branches.csv"));
    EXPECT_THAT(marks, ::testing::StartsWith("name,kind,x,y,angle_1,angle_2,angle_3\nbranch "));
    EXPECT_THAT(marks, HasSubstr("\ncrossing "));
  }
  const auto landmarks = read_landmarks<2>(folder / "landmarks.csv");
  const auto truth = read_displacement_field<2>(folder / "truth.mha");
  EXPECT_EQ(truth.size(), fixed.image.size());
  EXPECT_GT(landmarks.size(), 60);
  const auto phantom = nlohmann::json::parse(testing::read_text(folder / "phantom.json"));
  EXPECT_EQ(phantom["kind"], "mammogram");
  EXPECT_EQ(phantom["view"], "mlo");
  EXPECT_EQ(phantom["pair"], "temporal");
  EXPECT_EQ(phantom["bits"], 8);
  EXPECT_EQ(phantom["mass"], "moving");
  for (const char* name : {"gain", "gamma", "rotation_deg", "wave_x1_amplitude_mm", "density",
                           "determinant_min", "mass_radius_mm"}) {
    EXPECT_TRUE(phantom["parameters"].contains(name)) << name;
  }
  EXPECT_GT(phantom["fixed"]["nipple_mm"][0].get<double>(), 100);
}

TEST(PhantomCommand, MammogramsOfAnElasticBody) {
  const TemporaryFolder folder;
  const auto drawn = [&](const std::string& name, std::vector<std::string> more) {
    more.insert(more.begin(), {"phantom", "mammogram", "--size", "128", "--seed", "2", "--temporal",
                               "-o", (folder / name).string()});
    const auto run = run_crease(more);
    EXPECT_EQ(run.code, 0) << run.err;
    return nlohmann::json::parse(testing::read_text(folder / name / "phantom.json"));
  };
  const auto elastic = drawn("elastic", {"--elastic"}), smooth = drawn("smooth", {});
  EXPECT_EQ(elastic["motion"], "elastic");
  EXPECT_EQ(smooth["motion"], "smooth");
  EXPECT_GT(elastic["parameters"]["determinant_min"].get<double>(), 0.4);
  for (const char* same : {"fixed.mha", "mask.mha", "branches.csv"}) {
    EXPECT_EQ(testing::read_text(folder / "elastic" / same),
              testing::read_text(folder / "smooth" / same))
        << same;
  }
  for (const char* other : {"moving.mha", "truth.mha", "moving-feature-lines.csv"}) {
    EXPECT_NE(testing::read_text(folder / "elastic" / other),
              testing::read_text(folder / "smooth" / other))
        << other;
  }
}

TEST(PhantomCommand, MammogramsOfBothBreastsFromAbove) {
  const TemporaryFolder folder;
  const auto run = run_crease({"phantom", "mammogram", "--size", "128", "--bilateral", "--view",
                               "cc", "--density", "0.9", "-o", folder.path().string()});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(read_image<2>(folder / "moving.mha").pixel_type, PixelType::kUint16);
  EXPECT_FALSE(std::filesystem::exists(folder / "feature-lines.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder / "labels.mha"));
  const auto phantom = nlohmann::json::parse(testing::read_text(folder / "phantom.json"));
  EXPECT_EQ(phantom["moving_mirrored"], true);
  const auto again = run_crease({"phantom", "--config", (folder / "config.toml").string(), "-o",
                                 (folder / "again").string(), "--threads", "1"});
  ASSERT_EQ(again.code, 0) << again.err;
  for (const char* name :
       {"fixed.mha", "moving.mha", "truth.mha", "landmarks.csv", "phantom.json", "branches.csv"}) {
    EXPECT_EQ(testing::read_text(folder / name), testing::read_text(folder / "again" / name))
        << name;
  }
}

TEST(PhantomCommand, RefusesMammogramsItCannotDraw) {
  const TemporaryFolder folder;
  const std::string output = (folder / "x").string();
  const auto refused = [&](std::vector<std::string> arguments, const std::string& text) {
    arguments.insert(arguments.end(), {"-o", output});
    const auto run = run_crease(arguments);
    EXPECT_EQ(run.code, 2) << ::testing::PrintToString(arguments);
    EXPECT_THAT(run.err, HasSubstr(text));
  };
  refused({"phantom", "mammogram", "--size", "100"}, "--size 100 is not in 128 .. 4096");
  refused({"phantom", "mammogram", "--temporal", "--bilateral"}, "exclude each other");
  refused({"phantom", "mammogram", "--bits", "10"}, "choose 8, 12 or 16");
  refused({"phantom", "mammogram", "--view", "top"}, "--view");
  refused({"phantom", "mammogram", "--density", "2"}, "--density");
  refused({"phantom", "mammogram", "--mass", "both"}, "--mass");
  refused({"phantom", "mammogram", "--noise", "0.7"}, "--noise");
  refused({"phantom", "mammogram", "--no-texture"}, "--no-texture");
  refused({"phantom", "mammogram", "--landmark-noise", "1"}, "--landmark-noise");
  refused({"phantom", "mammogram", "--dimension", "3"}, "--dimension 3");
  refused({"phantom", "bodies", "--view", "cc"}, "--view is for mammograms, not for bodies");
  refused({"phantom", "blobs", "--elastic"}, "--elastic is for mammograms, not for blobs");
  refused({"phantom", "spine", "--no-label"}, "--no-label is for mammograms");
  EXPECT_FALSE(std::filesystem::exists(output));
}

TEST(PhantomCommand, SeedAloneDecidesTheBytes) {
  const TemporaryFolder folder;
  const auto bytes = [&](const std::string& name, const std::string& seed,
                         const std::string& threads) {
    const std::string output = (folder / name).string();
    EXPECT_EQ(run_crease({"phantom", "spine", "--size", "64", "--seed", seed, "--threads", threads,
                          "-o", output})
                  .code,
              0);
    return testing::read_text(folder / (name + "/fixed.mha"));
  };
  const std::string first = bytes("a", "5", "1");
  EXPECT_EQ(bytes("b", "5", "8"), first);
  EXPECT_NE(bytes("c", "6", "1"), first);
}

TEST(PhantomCommand, ConfigurationRepeatsIt) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_crease({"phantom", "spine", "--size", "64", "--noise", "0.03", "--no-texture", "-o",
                        (folder / "a").string()})
                .code,
            0);
  const auto again = run_crease(
      {"phantom", "--config", (folder / "a/config.toml").string(), "-o", (folder / "b").string()});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(testing::read_text(folder / "a/fixed.mha"), testing::read_text(folder / "b/fixed.mha"));
}

TEST(PhantomCommand, RefusesWhatItCannotDraw) {
  const TemporaryFolder folder;
  const std::string output = (folder / "x").string();
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"phantom", "sliding", "-o", output},  // of a later version
           {"phantom", "bodies", "--size", "8", "-o", output},
           {"phantom", "bodies", "--noise", "0.9", "-o", output},
           {"phantom", "bodies", "--dimension", "3", "-o", output},
           {"phantom", "blobs", "--dimension", "3", "--size", "1000", "-o", output},
           {"phantom", "blobs", "--dimension", "4", "-o", output},
           {"phantom", "-o", output},
           {"phantom", "bodies"}}) {
    const auto run = run_crease(arguments);
    EXPECT_EQ(run.code, 2) << ::testing::PrintToString(arguments);
    EXPECT_THAT(run.err, ::testing::StartsWith("crease phantom: "));
  }
  EXPECT_FALSE(std::filesystem::exists(output));
}

}  // namespace
}  // namespace crease
