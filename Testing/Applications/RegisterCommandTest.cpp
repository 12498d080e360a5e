// `crease register` on small phantoms: what it writes, and that this depends on its input alone.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "Registration/Landmarks.h"
#include "Testing/Applications/RegisterFixture.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using testing::read_result;
using testing::read_text;

class RegisterCommand : public testing::RegisterFixture {
 protected:
  /// Mean distance of the result from the phantom's truth, mm, four pixels away from the border.
  double mean_error() const {
    const auto found = read_displacement_field<2>(folder / "out/displacement.mha");
    const auto truth = read_displacement_field<2>(image("truth.mha"));
    double sum = 0;
    int count = 0;
    for (int j = 4; j < found.size()[1] - 4; ++j) {
      for (int i = 4; i < found.size()[0] - 4; ++i, ++count) {
        sum += (found(i, j) - truth(i, j)).norm();
      }
    }
    return sum / count;
  }
};

TEST_F(RegisterCommand, WritesEverythingAndNothingElse) {
  const auto run = this->run();
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err, "");  // --quiet
  EXPECT_EQ(
      files_in(folder / "out"),
      (std::set<std::string>{"config.toml", "displacement.mha", "jacobian.mha",
                             "pictures/checkerboard.png", "pictures/difference.png",
                             "pictures/fixed.png", "pictures/grid.png", "pictures/jacobian.png",
                             "pictures/moving.png", "pictures/strain.png", "pictures/warped.png",
                             "report.html", "result.json", "transform.json", "warped.mha"}));
  const auto result = read_result(output());
  EXPECT_EQ(result["command"], "register");
  EXPECT_EQ(result["status"], "ok");
  EXPECT_EQ(result["inputs"].size(), 2u);
  EXPECT_EQ(result["inputs"][0]["sha256"].get<std::string>().size(), 64u);
  for (const char* name :
       {"version", "format_version", "warnings", "timings_s", "peak_memory_mb", "threads", "metric",
        "ssd_reduction_percent", "ncc", "energies", "iterations", "stopped_because", "triangles",
        "control_points", "free_parameters", "jacobian", "landmarks", "bodies", "improved"}) {
    EXPECT_TRUE(result.contains(name)) << name;
  }
  EXPECT_EQ(result["metric"]["name"], "ssd");
  EXPECT_LT(result["metric"]["after"], result["metric"]["before"]);
  EXPECT_GT(result["ncc"]["after"], result["ncc"]["before"]);
  EXPECT_TRUE(result["improved"].get<bool>());
  EXPECT_GT(result["triangles"], 20);
  EXPECT_EQ(result["free_parameters"], 2 * result["control_points"].get<int>());
  EXPECT_GT(result["energies"]["bending"], 0);
  EXPECT_EQ(result["energies"]["rigidity"], 0);
  EXPECT_GT(result["timings_s"]["total"], 0);
  EXPECT_THAT(run.out, HasSubstr("triangles"));
  EXPECT_THAT(run.out, HasSubstr("ssd"));
}

TEST_F(RegisterCommand, PrintsExactlyResultJsonOnRequest) {
  const auto run = this->run({"--json", "--levels", "1"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out, read_text(folder / "out/result.json"));
}

TEST_F(RegisterCommand, RecoversASmoothWarpWithBothSplines) {
  ASSERT_EQ(run({"--mesh-size", "12", "--gamma", "0.01"}).code, 0);
  EXPECT_LT(mean_error(), 0.2);
  ASSERT_EQ(run({"--transform", "bspline", "--mesh-size", "8", "--gamma", "0.01"}).code, 0);
  EXPECT_LT(mean_error(), 0.15);
  const auto result = read_result(output());
  EXPECT_TRUE(result["triangles"].is_null());
  EXPECT_EQ(result["control_points"], 11 * 11);
}

TEST_F(RegisterCommand, MeetsExactLandmarksWithEveryNullSpaceAndOptimizer) {
  const std::string file = folder.write("pairs.csv",
                                        "fixed_x,fixed_y,moving_x,moving_y\n"
                                        "20,22,21.5,22\n40,30,40,31\n31,50,30,49.5\n");
  for (const char* null_space : {"elimination", "qr", "svd"}) {
    ASSERT_EQ(run({"--landmarks", file, "--null-space", null_space, "--levels", "1"}).code, 0);
    const auto landmarks = read_result(output())["landmarks"];
    EXPECT_EQ(landmarks["count"], 3);
    EXPECT_LT(landmarks["max_error_mm"], 64e-9) << null_space;
  }
  for (const char* optimizer : {"lbfgs", "conjugate-gradient", "steepest-descent"}) {
    ASSERT_EQ(run({"--landmarks", file, "--optimizer", optimizer, "--levels", "1"}).code, 0);
    EXPECT_LT(read_result(output())["landmarks"]["max_error_mm"], 64e-9) << optimizer;
  }
  ASSERT_EQ(run({"--landmarks", file, "--landmarks-mode", "soft", "--landmarks-sigma", "0.1"}).code,
            0);
  const double soft = read_result(output())["landmarks"]["max_error_mm"];
  EXPECT_GT(soft, 1e-6);
  EXPECT_LT(soft, 1);
}

TEST_F(RegisterCommand, RefinesRigidAndAffineMapsByEveryOptimizer) {
  for (const char* transform : {"rigid", "affine"}) {
    std::vector<double> after;
    for (const char* optimizer :
         {"gauss-newton", "lbfgs", "conjugate-gradient", "steepest-descent", "nelder-mead"}) {
      const auto metric =
          registered({"--transform", transform, "--optimizer", optimizer})["metric"];
      EXPECT_LT(metric["after"], metric["before"]) << optimizer;
      after.push_back(metric["after"]);
      EXPECT_NEAR(after.back(), after.front(), 0.01 * after.front()) << optimizer;
    }
  }
}

TEST_F(RegisterCommand, LooksAtAShareOfTheRowsOnCoarseLevels) {
  const auto displacement = [&](const std::vector<std::string>& extra) {
    EXPECT_EQ(run(extra).code, 0);
    return read_text(folder / "out/displacement.mha");
  };
  const std::string all = displacement({});
  const std::string some = displacement({"--sample-fraction", "0.4"});
  EXPECT_NE(some, all);
  EXPECT_EQ(displacement({"--sample-fraction", "0.4", "--threads", "1"}), some);
  EXPECT_NE(displacement({"--sample-fraction", "0.4", "--seed", "2"}), some);
  EXPECT_EQ(displacement({"--sample-fraction", "0.4", "--levels", "1"}),
            displacement({"--levels", "1"}));
}

TEST_F(RegisterCommand, ConfigurationRepeatsItToTheByte) {
  const std::string file =
      folder.write("pair #1.csv", "fixed_x,fixed_y,moving_x,moving_y\n20,22,21.5,22\n");
  ASSERT_EQ(run({"--landmarks", file, "--gamma", "0.0123456789012345678", "--no-creases",
                 "--interpolator", "linear"})
                .code,
            0);
  const std::string second = (folder / "second").string();
  const auto again =
      testing::run_crease({"register", "--config", (folder / "out/config.toml").string(),
                           "--output", second, "--quiet"});
  ASSERT_EQ(again.code, 0) << again.err;
  for (const char* name : {"displacement.mha", "warped.mha", "jacobian.mha", "transform.json"}) {
    EXPECT_EQ(read_text(folder / "out" / name), read_text(folder / "second" / name)) << name;
  }
}

TEST_F(RegisterCommand, ThreadsAndVerbosityChangeNoByte) {
  std::vector<std::pair<std::string, std::string>> first;
  for (const std::string threads : {"1", "2", "8"}) {
    auto arguments = std::vector<std::string>{"--threads", threads};
    if (threads == "8") arguments.emplace_back("--json");
    ASSERT_EQ(run(arguments).code, 0);
    EXPECT_EQ(read_result(output())["threads"], std::stoi(threads));
    std::vector<std::pair<std::string, std::string>> contents;
    for (const std::string& name : files_in(folder / "out")) {
      if (name == "result.json") continue;
      std::string text = read_text(folder / "out" / name);
      if (name == "report.html") {  // but for times, memory and the number of threads
        const auto varying = text.find("<!--varies-->");
        text.erase(varying, text.find("<!--/varies-->") - varying);
      }
      contents.emplace_back(name, std::move(text));
    }
    auto result = read_result(output());
    for (const char* volatile_field : {"timings_s", "threads", "peak_memory_mb"}) {
      result.erase(volatile_field);
    }
    contents.emplace_back("result.json", result.dump());
    if (first.empty()) first = contents;
    ASSERT_EQ(contents.size(), first.size());
    for (std::size_t i = 0; i < contents.size(); ++i) {
      EXPECT_TRUE(contents[i] == first[i])
          << contents[i].first << " with " << threads << " threads";
    }
  }
}

// Killed as soon as it has told of a stage. The mesh is so fine that the run would go on for seconds.
TEST_F(RegisterCommand, KilledRunsLeaveNoResult) {
  const auto result = folder / "out/result.json";
  const auto told = [](const std::string& stage) {
    return [text = "\"stage\":\"" + stage + "\""](const std::string& err) {
      return err.find(text) != std::string::npos;
    };
  };
  for (const char* stage : {"domain", "level"}) {
    ASSERT_EQ(run({"--levels", "1"}).code, 0);  // an earlier, complete run
    ASSERT_TRUE(std::filesystem::exists(result));
    const bool killed = testing::kill_crease(
        {"register", "--fixed", image("fixed.mha"), "--moving", image("moving.mha"), "--output",
         output(), "--mesh-size", "3", "--progress", "json"},
        told(stage));
    EXPECT_TRUE(killed) << stage;
    EXPECT_FALSE(std::filesystem::exists(result)) << stage;
  }
  // While results are written the run may well end first: a folder with result.json is complete.
  const bool killed = testing::kill_crease(
      {"register", "--fixed", image("fixed.mha"), "--moving", image("moving.mha"), "--output",
       output(), "--mesh-size", "16", "--progress", "json"},
      told("results"));
  if (std::filesystem::exists(result)) {
    EXPECT_EQ(read_result(output())["status"], "ok");
    EXPECT_TRUE(std::filesystem::exists(folder / "out/pictures/grid.png"));
  } else {
    EXPECT_TRUE(killed);
  }
  // The next run finds what was left, and leaves nothing of it.
  ASSERT_EQ(run({"--levels", "1"}).code, 0);
  EXPECT_TRUE(std::filesystem::exists(result));
  for (const std::string& name : files_in(folder / "out")) {
    EXPECT_EQ(name.find(".crease-"), std::string::npos) << name;
  }
}

TEST_F(RegisterCommand, TellsProgressAsJsonLines) {
  const auto run = testing::run_crease({"register", "--fixed", image("fixed.mha"), "--moving",
                                        image("moving.mha"), "--output", output(), "--mesh-size",
                                        "16", "--progress", "json"});
  ASSERT_EQ(run.code, 0) << run.err;
  std::istringstream lines(run.err);
  std::set<std::string> stages;
  double last = 0;
  for (std::string line; std::getline(lines, line);) {
    const auto object = nlohmann::json::parse(line);
    if (!object.contains("stage")) continue;
    stages.insert(object["stage"].get<std::string>());
    EXPECT_GE(object["fraction"].get<double>(), 0);
    EXPECT_LE(object["fraction"].get<double>(), 1);
    last = object["elapsed_s"];
  }
  for (const char* stage : {"reading", "domain", "level", "results"}) {
    EXPECT_TRUE(stages.contains(stage)) << stage;
  }
  EXPECT_GT(last, 0);
}

TEST_F(RegisterCommand, DoesNotOverwriteItsInputs) {
  const std::string input = (folder / "out/warped.mha").string();
  std::filesystem::create_directories(folder / "out");
  std::filesystem::copy_file(image("moving.mha"), input);
  const auto refused = run_with(image("fixed.mha"), input, {"--levels", "1"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("is an input of this run"));
  EXPECT_EQ(read_text(input), read_text(image("moving.mha")));
}

TEST_F(RegisterCommand, FormatsWithoutSpacingGetTheirGeometryBeside) {
  const auto as_png = [&](const char* name) {
    auto pixels = read_image<2>(image(std::string(name) + ".mha")).image;
    for (float& v : pixels.values()) v = std::clamp(200 * v, 0.0f, 255.0f);
    std::string file = (folder / (std::string(name) + ".png")).string();
    write_image(file, pixels, PixelType::kUint8);
    return file;
  };
  ASSERT_EQ(run_with(as_png("fixed"), as_png("moving"),
                     {"--spacing", "0.5,0.5", "--mesh-size", "8", "--gamma", "0.01"})
                .code,
            0);
  EXPECT_EQ(read_image<2>(folder / "out/warped.png").pixel_type, PixelType::kUint8);
  EXPECT_EQ(read_image<2>(folder / "out/warped.mha").image.raster().spacing, Vector<2>(0.5, 0.5));
  EXPECT_EQ(read_displacement_field<2>(folder / "out/displacement.mha").raster().spacing,
            Vector<2>(0.5, 0.5));
}

TEST_F(RegisterCommand, RecoversATranslationByRigidAndAffineMaps) {
  // The same image, moved in physical space: T(x) = x + (3, -2).
  const auto fixed = read_image<2>(image("fixed.mha")).image;
  Raster<2> raster = fixed.raster();
  raster.origin += Vector<2>(3, -2);
  write_image(folder / "moved.mha", Image<float, 2>(raster, fixed.values()), PixelType::kFloat);
  for (const char* transform : {"rigid", "affine"}) {
    const auto run = run_with(image("fixed.mha"), (folder / "moved.mha").string(),
                              {"--transform", transform, "--init", "identity"});
    ASSERT_EQ(run.code, 0) << run.err;
    double largest = 0;
    const auto field = read_displacement_field<2>(folder / "out/displacement.mha");
    for (const auto& u : field.values()) {
      largest = std::max(largest, (u - Vector<2>(3, -2)).norm());
    }
    EXPECT_LT(largest, 0.02) << transform;  // pixels
    const auto result = read_result(output());
    EXPECT_EQ(result["free_parameters"], std::string(transform) == "rigid" ? 3 : 6);
    EXPECT_LT(result["metric"]["after"], 1e-4 * result["metric"]["before"].get<double>());
  }
  // The map found is a start for the next run.
  const std::string start = (folder / "start.json").string();
  std::filesystem::rename(folder / "out/transform.json", start);
  const auto refined =
      run_with(image("fixed.mha"), (folder / "moved.mha").string(), {"--init", start});
  ASSERT_EQ(refined.code, 0) << refined.err;
  EXPECT_NEAR(read_result(output())["jacobian"]["min"].get<double>(), 1, 0.01);
}

TEST_F(RegisterCommand, FitsLandmarksAloneByRigidMaps) {
  const std::string file = folder.write("pairs.csv",
                                        "fixed_x,fixed_y,moving_x,moving_y\n"
                                        "0,0,5,1\n10,0,5,11\n0,10,-5,1\n");
  ASSERT_EQ(
      run({"--transform", "rigid", "--metric", "none", "--landmarks", file, "--init", "landmarks"})
          .code,
      0);
  EXPECT_LT(read_result(output())["landmarks"]["max_error_mm"], 1e-12);  // 90 degrees, (5, 1)
  // x' = 5 - y: from row 6 on nothing is there.
  const auto warped = read_image<2>(folder / "out/warped.mha").image;
  for (int row = 6; row < 64; ++row) EXPECT_EQ(warped(20, row), 0) << row;
  EXPECT_NE(warped(20, 5), 0);
}

/// A volume of soft blobs, and the same 1.5 mm further along x.
class RegisterVolumes : public RegisterCommand {
 protected:
  void SetUp() override {
    Raster<3> raster;
    raster.size = {24, 20, 18};
    raster.spacing = {1, 1, 1.5};
    for (const double shift : {0.0, 1.5}) {
      Image<float, 3> volume(raster);
      for (int k = 0; k < 18; ++k) {
        for (int j = 0; j < 20; ++j) {
          for (int i = 0; i < 24; ++i) {
            const Point<3> x = raster.point(Vector<3>(i, j, k)) - Vector<3>(shift, 0, 0);
            volume(i, j, k) = static_cast<float>(blob(x, {9, 8, 11}, 4) + blob(x, {15, 12, 16}, 3) +
                                                 0.5 * blob(x, {8, 14, 18}, 3));
          }
        }
      }
      const auto file = folder / (shift == 0 ? "fixed.nii.gz" : "moving.nii.gz");
      write_image(file, volume, PixelType::kFloat);
    }
  }
  static double blob(const Point<3>& x, const Point<3>& center, double sigma) {
    return std::exp(-(x - center).squaredNorm() / (2 * sigma * sigma));
  }
  double largest_error() const {
    const auto field = read_displacement_field<3>(folder / "out/displacement.mha");
    double largest = 0;
    for (int k = 6; k < 12; ++k) {
      for (int j = 6; j < 14; ++j) {
        for (int i = 6; i < 18; ++i) {
          largest = std::max(largest, (field(i, j, k) - Vector<3>(1.5, 0, 0)).norm());
        }
      }
    }
    return largest;
  }
};

TEST_F(RegisterVolumes, RegistersRigidAffineAndTensorSplines) {
  for (const char* transform : {"rigid", "affine", "bspline"}) {
    std::vector<std::string> extra = {"--transform", transform};
    if (std::string(transform) == "bspline")
      extra.insert(extra.end(), {"--mesh-size", "8", "--gamma", "0.01"});
    const auto run =
        run_with((folder / "fixed.nii.gz").string(), (folder / "moving.nii.gz").string(), extra);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_LT(largest_error(), std::string(transform) == "bspline" ? 0.2 : 0.05) << transform;
    EXPECT_EQ(read_image<3>(folder / "out/warped.nii.gz").image.size(),
              (std::array<int, 3>{24, 20, 18}));
    EXPECT_TRUE(std::filesystem::exists(folder / "out/pictures/grid.png"));
  }
}

}  // namespace
}  // namespace crease
