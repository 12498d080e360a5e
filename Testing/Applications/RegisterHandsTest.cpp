// Two X-rays of hands, end to end through the command: rigid bones in soft tissue under a large rotation.
// Data: hands of the FAIR toolbox, after Y. Amit, "A Nonlinear Variational Problem for Image Matching", SIAM
// J. Sci. Comput. 15, 1994; 128 x 128 pixels for 200 x 250 mm. The bones' outlines were drawn by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "Core/Error.h"
#include "Core/Point.h"
#include "Testing/Applications/CommandRunner.h"
#include "Testing/TemporaryFolder.h"
#include "Transforms/TransformFile.h"

namespace crease {
namespace {

using testing::read_result;
using testing::run_crease;

const Vector<2> kSpacing(200.0 / 128, 250.0 / 128);  // mm
constexpr const char* kSpacingText = "1.5625,1.953125";

Point<2> in_mm(double column, double row) { return kSpacing.cwiseProduct(Point<2>(column, row)); }

/// Metacarpals and first phalanges of three fingers in the fixed image: pixels, clockwise.
const std::map<std::string, std::vector<Point<2>>> kBones = {{"metacarpal 2",
                                                              {{47.5, 67.2},
                                                               {50, 66.8},
                                                               {52.3, 69},
                                                               {53, 74},
                                                               {54, 79},
                                                               {55.6, 84.5},
                                                               {58.5, 89.5},
                                                               {57.5, 93},
                                                               {52.3, 93},
                                                               {52, 87},
                                                               {50.3, 81.5},
                                                               {47.6, 76},
                                                               {45, 72.2},
                                                               {45.6, 69.3}}},
                                                             {"metacarpal 3",
                                                              {{60, 68},
                                                               {63, 67},
                                                               {65.5, 69},
                                                               {66, 72.5},
                                                               {65, 77},
                                                               {65, 83},
                                                               {66.2, 88},
                                                               {66, 91},
                                                               {61, 91},
                                                               {61.2, 84},
                                                               {60.8, 79},
                                                               {59.7, 75},
                                                               {58, 72},
                                                               {58.5, 70}}},
                                                             {"metacarpal 4",
                                                              {{71.5, 71},
                                                               {74, 70.6},
                                                               {76, 71.8},
                                                               {76, 75},
                                                               {75, 79},
                                                               {73.5, 85},
                                                               {72.8, 89},
                                                               {69, 90.5},
                                                               {69.5, 87.5},
                                                               {71, 84},
                                                               {70.7, 78},
                                                               {70.2, 74}}},
                                                             {"phalanx 2",
                                                              {{44, 49},
                                                               {48.8, 48.8},
                                                               {49, 54},
                                                               {50, 59},
                                                               {52.2, 64.5},
                                                               {51.5, 65.8},
                                                               {45.5, 66},
                                                               {44, 64.5},
                                                               {44.6, 60},
                                                               {44.8, 55},
                                                               {43.8, 51}}},
                                                             {"phalanx 3",
                                                              {{60, 46.5},
                                                               {65, 46.2},
                                                               {65.2, 52},
                                                               {65, 58},
                                                               {66, 63},
                                                               {65.8, 65},
                                                               {58, 65},
                                                               {58.2, 62.5},
                                                               {59.3, 58},
                                                               {59.8, 52}}},
                                                             {"phalanx 4",
                                                              {{73, 50.5},
                                                               {77.6, 50},
                                                               {77.4, 55},
                                                               {76.8, 61},
                                                               {77, 67},
                                                               {75.5, 69},
                                                               {70.2, 68},
                                                               {70.5, 66},
                                                               {72, 62},
                                                               {72.6, 56}}}};

/// The dark spot where an artery enters the shaft of metacarpal 2, seen in both images: pixels.
const Point<2> kForamenFixed(52, 81.6), kForamenMoving(44, 76);

std::string outlines_csv() {
  std::string text = "line,x,y\n";
  for (const auto& [name, outline] : kBones) {
    for (std::size_t i = 0; i <= outline.size(); ++i) {
      const Point<2> p = in_mm(outline[i % outline.size()].x(), outline[i % outline.size()].y());
      text += message(name, ",", p.x(), ",", p.y(), "\n");
    }
  }
  return text;
}

/// The published pairs: columns 7 and 8 are pixels of the fixed image, 5 and 6 of the moving one.
std::string landmarks_csv(const std::string& published) {
  std::ostringstream text;
  text.precision(17);
  text << "fixed_x,fixed_y,moving_x,moving_y\n";
  std::istringstream lines(testing::read_text(published));
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || std::isdigit(static_cast<unsigned char>(line.front())) == 0) continue;
    std::array<double, 8> numbers{};
    std::istringstream cells(line);
    for (double& number : numbers) {
      cells >> number;
      cells.ignore();  // the comma
    }
    const Point<2> fixed = in_mm(numbers[6], numbers[7]), moving = in_mm(numbers[4], numbers[5]);
    text << fixed.x() << ',' << fixed.y() << ',' << moving.x() << ',' << moving.y() << '\n';
  }
  return text.str();
}

double miss_at_foramen_mm(const std::filesystem::path& transform) {
  const Point<2> mapped =
      load_transform<2>(transform)->map(in_mm(kForamenFixed.x(), kForamenFixed.y()));
  return (mapped - in_mm(kForamenMoving.x(), kForamenMoving.y())).norm();
}

}  // namespace

TEST(RegisterRealImages, Hands) {
  const std::string published = testing::shared_file("landmarks/hands/landmarks.csv");
  const std::string fixed = testing::shared_file("landmarks/hands/hands-R.jpg");
  const std::string moving = testing::shared_file("landmarks/hands/hands-T.jpg");
  if (published.empty() || fixed.empty() || moving.empty()) {
    GTEST_SKIP() << "the hands are not there";
  }
  const testing::TemporaryFolder folder;
  const std::string bones = folder.write("bones.csv", outlines_csv());
  const std::string landmarks = folder.write("landmarks.csv", landmarks_csv(published));
  const auto registered = [&](const std::string& name, const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"register",
                                          "--fixed",
                                          fixed,
                                          "--moving",
                                          moving,
                                          "--spacing",
                                          kSpacingText,
                                          "--landmarks",
                                          landmarks,
                                          "--output",
                                          (folder / name).string(),
                                          "--quiet"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const auto run = run_crease(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return read_result(folder / name);
  };
  const auto remaining_ssd = [&](const std::string& name) {
    const auto run = run_crease(
        {"evaluate", "--transform", (folder / name / "transform.json").string(), "--fixed", fixed,
         "--moving", moving, "--spacing", kSpacingText, "--json", "--quiet"});
    EXPECT_EQ(run.code, 0) << run.err;
    return nlohmann::json::parse(run.out)["ssd"]["after"].get<double>();
  };
  registered("affine", {"--transform", "affine", "--metric", "none"});
  const auto result =
      registered("creased", {"--feature-lines", bones, "--beta", "10", "--gamma", "1"});

  EXPECT_EQ(result["landmarks"]["count"], 7);
  EXPECT_LT(result["landmarks"]["max_error_mm"], 1e-9 * std::hypot(200, 250));
  EXPECT_EQ(result["jacobian"]["folded_samples"], 0);
  EXPECT_GT(result["jacobian"]["min"], 0.1);
  // The landmarks' affine map leaves 3.8 times as much.
  EXPECT_LT(remaining_ssd("creased"), 0.35 * remaining_ssd("affine"));
  EXPECT_GT(result["ncc"]["after"], 0.96);
  ASSERT_EQ(result["bodies"].size(), kBones.size());
  for (const auto& body : result["bodies"]) {
    EXPECT_LT(body["rms_nonrigidity_mm"], 0.5) << body.dump();  // under a third of a pixel
    EXPECT_GT(std::abs(body["angle_deg"].get<double>()), 15) << body.dump();
  }
  // No landmark and no outline tells of the spot: the affine map misses it by 7 mm.
  EXPECT_LT(miss_at_foramen_mm(folder / "creased/transform.json"), kSpacing.norm());  // one pixel
  EXPECT_GT(miss_at_foramen_mm(folder / "affine/transform.json"), 2 * kSpacing.norm());
}

}  // namespace crease
