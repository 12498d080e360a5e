// `crease elastic` on a small phantom: what it writes, and that this depends on its input alone.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "Registration/Landmarks.h"
#include "Testing/Applications/ElasticFixture.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/TransformFile.h"

namespace crease {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::read_result;
using testing::read_text;
using testing::run_crease;

class ElasticCommand : public testing::ElasticFixture {};

TEST_F(ElasticCommand, WritesEverythingAndNothingElse) {
  const auto run = this->run({"--truth", file("truth.mha")});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err, "");  // --quiet
  EXPECT_EQ(files_in(folder / "out"),
            (std::set<std::string>{
                "config.toml", "displacement.mha", "jacobian.mha", "pairs.csv",
                "pictures/checkerboard.png", "pictures/difference.png", "pictures/fixed.png",
                "pictures/grid.png", "pictures/jacobian.png", "pictures/mesh.png",
                "pictures/moving.png", "pictures/stiffness.png", "pictures/warped.png",
                "report.html", "result.json", "transform.json", "warped.mha"}));
  const auto result = read_result(output());
  EXPECT_EQ(result["command"], "elastic");
  EXPECT_EQ(result["status"], "ok");
  EXPECT_EQ(result["inputs"].size(), 4u);
  EXPECT_EQ(result["pairs"]["count"], 16);
  EXPECT_EQ(result["pairs"]["contour"], 0);
  EXPECT_LT(result["pairs"]["after_pairs"]["max_error_mm"], 1e-9 * kSize);
  EXPECT_NEAR(result["triangles"].get<double>(), 80, 8);
  EXPECT_EQ(result["load_steps"].size(), 2u);
  EXPECT_EQ(result["load_fraction"], 1);
  EXPECT_EQ(result["refinement"].size(), 2u);
  const double by_pairs = result["improvement_percent"]["pairs"];
  const double by_images = result["improvement_percent"]["refinement"];
  EXPECT_GT(by_pairs, 20);
  EXPECT_GT(by_images, by_pairs);
  EXPECT_LT(result["tre_mm"]["pairs"]["rms"], result["tre_mm"]["before"]["rms"]);
  EXPECT_GT(result["jacobian"]["min"], 0);
  EXPECT_GT(result["timings_s"]["total"], 0);
  for (const char* text : {"16: 16 given", "load step 2", "refinement by 1", "improvement",
                           "target error", "invertible"}) {
    EXPECT_THAT(run.out, HasSubstr(text));
  }
}

TEST_F(ElasticCommand, PrintsExactlyResultJsonOnRequest) {
  const auto run = this->run({"--json", "--no-refine"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out, read_text(folder / "out/result.json"));
  EXPECT_TRUE(read_result(output())["refinement"].is_null());
  EXPECT_TRUE(read_result(output())["improvement_percent"]["refinement"].is_null());
}

// x -> y + u*(y), y = x + v(x): the file holds both splines, and other commands read it.
TEST_F(ElasticCommand, WritesACompositeThatOtherCommandsRead) {
  registered();
  const auto transform = load_transform<2>(folder / "out/transform.json");
  const auto* composite = dynamic_cast<const CompositeTransform<2>*>(transform.get());
  ASSERT_NE(composite, nullptr);
  ASSERT_EQ(composite->num_parts(), 2u);
  const auto displacement = read_displacement_field<2>(folder / "out/displacement.mha");
  for (const auto& [i, j] : {std::pair(7, 50), std::pair(31, 20), std::pair(63, 0)}) {
    const Point<2> x = displacement.raster().point({i, j});
    EXPECT_LT((transform->map(x) - x - displacement(i, j)).norm(), 1e-12);
  }
  const auto pairs = read_landmarks<2>(folder / "out/pairs.csv");
  EXPECT_LT((composite->part(1).map(pairs.fixed[5]) - pairs.moving[5]).norm(), 1e-9 * kSize);

  const std::string file = (folder / "out/transform.json").string();
  EXPECT_EQ(testing::run_crease({"info", file}).code, 0);
  const auto warped =
      testing::run_crease({"warp", "--transform", file, "--moving", this->file("moving.mha"),
                           "--reference", this->file("fixed.mha"), "--output-image",
                           (folder / "warped.mha").string(), "--interpolator", "cubic", "--quiet"});
  ASSERT_EQ(warped.code, 0) << warped.err;
  const auto once = read_image<2>(folder / "out/warped.mha").image;
  const auto again = read_image<2>(folder / "warped.mha").image;
  EXPECT_NEAR(once(30, 30), again(30, 30), 1e-5);
  const auto evaluated = testing::run_crease(
      {"evaluate", "--transform", file, "--truth", this->file("truth.mha"), "--json"});
  ASSERT_EQ(evaluated.code, 0) << evaluated.err;
  const auto figures = nlohmann::json::parse(evaluated.out);
  EXPECT_EQ(figures["jacobian"]["certified_positive"], true);
  const auto inverse = testing::run_crease({"warp", "--transform", file, "--inverse",
                                            "--displacement", (folder / "inverse.mha").string(),
                                            "--reference", this->file("moving.mha"), "--quiet"});
  EXPECT_EQ(inverse.code, 0) << inverse.err;
}

TEST_F(ElasticCommand, TheConfigurationItWritesRepeatsTheRun) {
  registered({"--young", "2000", "--poisson", "0.4", "--smoothing", "1,0.5", "--plane", "strain"});
  const std::string first = read_text(folder / "out/displacement.mha");
  const auto config = folder.write("copy.toml", read_text(folder / "out/config.toml"));
  const auto again = testing::run_crease({"elastic", "--config", config, "--quiet"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(read_text(folder / "out/displacement.mha"), first);
}

TEST_F(ElasticCommand, SameBytesOnAnyNumberOfThreads) {
  const auto bytes = [&](const char* threads) {
    registered({"--threads", threads, "--regions", file("labels.mha"), "--young", "1=9"});
    std::string all;
    for (const char* name : {"displacement.mha", "jacobian.mha", "transform.json", "warped.mha",
                             "pictures/stiffness.png", "pictures/mesh.png"}) {
      all += read_text(folder / "out" / name);
    }
    return all;
  };
  const std::string one = bytes("1");
  EXPECT_EQ(bytes("2"), one);
  EXPECT_EQ(bytes("8"), one);
}

TEST_F(ElasticCommand, TissuesHaveMaterialsOfTheirOwn) {
  const auto result =
      registered({"--regions", file("labels.mha"), "--young", "500,1=9000", "--poisson", "0.3"});
  EXPECT_EQ(result["material"]["regions"]["1"]["young"], 9000);
  EXPECT_EQ(result["material"]["breast"]["poisson"], 0.3);
  EXPECT_TRUE(result["material"]["muscle_label"].is_null());
}

TEST_F(ElasticCommand, SaysWhenImagesAreEqualAlready) {
  const auto pairs = folder.write(
      "rest.csv", "fixed_x,fixed_y,moving_x,moving_y\n6,6,6,6\n57,8,57,8\n9,50,9,50\n");
  const auto run = run_with(file("fixed.mha"), file("fixed.mha"), {"--pairs", pairs});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("images already equal"));
  const auto result = read_result(output());
  EXPECT_EQ(result["images_equal"], true);
  EXPECT_TRUE(result["improvement_percent"]["pairs"].is_null());
  const auto displacement = read_displacement_field<2>(folder / "out/displacement.mha");
  for (const auto& u : displacement.values()) ASSERT_LT(u.norm(), 1e-9);
}

TEST_F(ElasticCommand, DampedIterationIsThereToCompareWith) {
  const auto damped =
      registered({"--refinement", "damped", "--damped-step", "0.05", "--levels", "1"});
  const auto newton = registered({"--levels", "1"});
  EXPECT_GT(damped["refinement"][0]["iterations"], newton["refinement"][0]["iterations"]);
}

TEST_F(ElasticCommand, EveryMetricAndScheduleRuns) {
  for (const char* metric : {"ncc", "lncc", "mi", "nmi"}) {
    EXPECT_EQ(registered({"--metric", metric, "--levels", "1"})["status"], "ok") << metric;
  }
  EXPECT_EQ(registered({"--steps", "adaptive", "--material", "neo-hookean"})["load_fraction"], 1);
  EXPECT_EQ(registered({"--steps", "5", "--corrector", "none", "--no-refine"})["status"], "ok");
  EXPECT_EQ(registered({"--degree", "1", "--no-refine"})["status"], "ok");
  EXPECT_EQ(registered({"--degree", "3", "--mesh-size", "20"})["status"], "ok");
  EXPECT_EQ(registered({"--pin", "contour", "--alpha", "5", "--mean-dilatation"})["status"], "ok");
}

TEST_F(ElasticCommand, TheReportShowsStepsAndLevels) {
  registered();
  const std::string page = read_text(folder / "out/report.html");
  for (const char* text : {"Load steps", "Refinement", "s modulus", "Jacobian", "Swipe",
                           "crease elastic --config config.toml"}) {
    EXPECT_THAT(page, HasSubstr(text));
  }
}

// A run that is killed leaves no result.json, and one begun in its folder takes the old one away.
TEST_F(ElasticCommand, AKilledRunLeavesNoResult) {
  const auto result = folder / "out/result.json";
  const auto kill_at = [&](const std::string& stage) {
    return testing::kill_crease(
        {"elastic", "--fixed", file("fixed.mha"), "--moving", file("moving.mha"), "--output",
         output(), "--roi", "image", "--pairs", file("pairs.csv"), "--progress", "json"},
        [&](const std::string& err) {
          return err.find("\"stage\":\"" + stage + "\"") != std::string::npos;
        });
  };
  for (const char* stage : {"domain", "load steps"}) {
    ASSERT_EQ(run({"--no-refine"}).code, 0);  // an earlier, complete run
    ASSERT_TRUE(std::filesystem::exists(result));
    EXPECT_TRUE(kill_at(stage)) << stage;
    EXPECT_FALSE(std::filesystem::exists(result)) << stage;
  }
  // Later the run may well end first: a folder with result.json is complete.
  const bool killed = kill_at("results");
  if (std::filesystem::exists(result)) {
    EXPECT_EQ(read_result(output())["status"], "ok");
    EXPECT_TRUE(std::filesystem::exists(folder / "out/pictures/mesh.png"));
  } else {
    EXPECT_TRUE(killed);
  }
}

/// Forks of ducts as pairs, without the skin's: these are found in the images.
void write_forks(const std::string& landmarks, const std::string& to) {
  std::ifstream all(landmarks);
  std::ofstream forks(to);
  for (std::string line; std::getline(all, line);) {
    if (line.find("contour") == std::string::npos && line.find("nipple") == std::string::npos) {
      forks << line << '\n';
    }
  }
}

// Given pairs have directions, those along the skin have none: none are written.
TEST_F(ElasticCommand, FindsThePairsAlongTheSkinOfMammograms) {
  const auto in = [&](const char* name) { return (folder / name).string(); };
  ASSERT_EQ(run_crease({"phantom", "mammogram", "--seed", "3", "--size", "256", "--output",
                        folder.path().string(), "--quiet"})
                .code,
            0);
  write_forks(in("landmarks.csv"), in("forks.csv"));
  const auto finished = run_crease({"elastic", "--fixed", in("fixed.mha"), "--moving",
                                    in("moving.mha"), "--pairs", in("forks.csv"), "--contour-pairs",
                                    "7", "--no-refine", "--output", output(), "--quiet"});
  const auto result = result_of(finished);
  EXPECT_EQ(result["pairs"]["contour"], 7);
  EXPECT_GT(result["pairs"]["given"], 10);
  EXPECT_TRUE(result["breast"]["pectoral_muscle"].get<bool>());
  const auto pairs = read_landmarks<2>(folder / "out/pairs.csv");
  EXPECT_EQ(pairs.size(), result["pairs"]["count"].get<int>());
  EXPECT_TRUE(pairs.fixed_angle.empty());
  EXPECT_TRUE(pairs.moving_angle.empty());
}

}  // namespace
}  // namespace crease
