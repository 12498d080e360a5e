// Walks through the table of the guide's page "Choosing a transform": what it says works must work and improve
// the match, and what it says does not must be refused by name.
#include <fstream>
#include <map>
#include <sstream>

#include "Registration/Landmarks.h"
#include "Testing/Applications/RegisterFixture.h"

namespace crease {
namespace {

using Arguments = std::vector<std::string>;

/// Cells of a Markdown table's row, without spaces and backquotes.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line.substr(1));
  for (std::string cell; std::getline(stream, cell, '|');) {
    std::erase(cell, '`');
    const auto first = cell.find_first_not_of(' ');
    cells.push_back(first == std::string::npos
                        ? ""
                        : cell.substr(first, cell.find_last_not_of(' ') + 1 - first));
  }
  return cells;
}

struct Combination {
  std::string transform, feature, verdict;
};

/// The table below the page's mark, cell by cell.
std::vector<Combination> read_table() {
  std::ifstream page(CREASE_TRANSFORM_PAGE);
  std::string line;
  while (std::getline(page, line) && line != "<!-- combinations -->") continue;
  while (std::getline(page, line) && !line.starts_with('|')) continue;
  const auto features = cells_of(line);
  std::getline(page, line);  // the rule below the head
  std::vector<Combination> all;
  while (std::getline(page, line) && line.starts_with('|')) {
    const auto cells = cells_of(line);
    for (std::size_t k = 1; k < features.size(); ++k) {
      all.push_back({cells.at(0), features[k], cells.at(k)});
    }
  }
  return all;
}

std::vector<std::string> transforms_of(const std::vector<Combination>& table) {
  std::vector<std::string> names;
  for (const auto& cell : table) {
    if (names.empty() || names.back() != cell.transform) names.push_back(cell.transform);
  }
  return names;
}

class RegisterCombinations : public testing::RegisterFixture {
 protected:
  void SetUp() override {
    const Phantom phantom = make_phantom("blobs", {.size = 64});
    Landmarks<2> landmarks;
    for (const Point<2>& p : {Point<2>(14, 12), Point<2>(46, 20), Point<2>(30, 49)}) {
      landmarks.fixed.push_back(p);
      landmarks.moving.push_back(phantom.truth(p));
    }
    write_landmarks(folder / "landmarks.csv", landmarks);
    LabelImage<2> labels(phantom.fixed.raster());
    for (int j = 24; j < 40; ++j) {
      for (int i = 22; i < 38; ++i) labels(i, j) = 1;
    }
    write_labels(folder / "labels.mha", labels);
    folder.write("lines.csv", "line,x,y\n1,10,30\n1,50,34\n");
    folder.write("region.csv", "ring,x,y\n1,4,4\n1,58,4\n1,58,58\n1,4,58\n");
    const VolumePhantom volume = make_volume_phantom("blobs", {.size = 16, .texture = false});
    write_image(folder / "fixed3.mha", volume.fixed, PixelType::kFloat);
    write_image(folder / "moving3.mha", volume.moving, PixelType::kFloat);
  }
  std::string file(const char* name) const { return (folder / name).string(); }

  /// What the columns of the table ask of the command.
  Arguments arguments_of(const std::string& feature) const {
    const std::map<std::string, Arguments> known = {
        {"3D", {}},
        {"landmarks alone", {"--metric", "none", "--landmarks", file("landmarks.csv")}},
        {"exact landmarks", {"--landmarks", file("landmarks.csv")}},
        {"soft landmarks", {"--landmarks", file("landmarks.csv"), "--landmarks-mode", "soft"}},
        {"rigid labels", {"--rigid-labels", file("labels.mha")}},
        {"feature lines", {"--feature-lines", file("lines.csv")}},
        {"region", {"--roi", file("region.csv")}},
        {"gauss-newton", {"--optimizer", "gauss-newton"}},
        {"lbfgs", {"--optimizer", "lbfgs"}},
        {"conjugate-gradient", {"--optimizer", "conjugate-gradient"}},
        {"steepest-descent", {"--optimizer", "steepest-descent"}},
        {"nelder-mead", {"--optimizer", "nelder-mead"}},
        {"adaptive", {"--adapt", "1"}},
        {"certificate", {"--require-invertible"}},
    };
    const auto found = known.find(feature);
    EXPECT_NE(found, known.end()) << "the table has a column that is not tested: " << feature;
    return found == known.end() ? Arguments{} : found->second;
  }

  testing::CommandResult run_combination(const std::string& transform, const Arguments& extra,
                                         bool volumes = false) const {
    Arguments arguments = {"--transform", transform, "--levels", "2"};
    if (transform == "rigid" || transform == "similarity" || transform == "affine") {
      arguments.insert(arguments.end(), {"--init", "identity"});
    }
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    std::filesystem::remove_all(folder / "out");
    if (volumes) return run_with(file("fixed3.mha"), file("moving3.mha"), arguments);
    return run(arguments);
  }
  void expect_works(const testing::CommandResult& run, const std::string& name) const {
    ASSERT_EQ(run.code, 0) << name << ": " << run.err;
    const auto result = testing::read_result(output());
    EXPECT_EQ(result["status"], "ok") << name;
    EXPECT_TRUE(result["improved"]) << name;
    EXPECT_EQ(result["jacobian"]["folded_samples"], 0) << name;
  }
};

TEST_F(RegisterCombinations, AreAsTheTableOfTheGuideSays) {
  const auto table = read_table();
  ASSERT_GE(table.size(), 100u);
  for (const auto& [transform, feature, verdict] : table) {
    const std::string name = message(transform, " with ", feature);
    const auto finished = run_combination(transform, arguments_of(feature), feature == "3D");
    if (verdict == "yes" || verdict == "start" || verdict == "samples") {
      expect_works(finished, name);
    } else {
      EXPECT_EQ(finished.code, 2) << name << " is not refused: " << finished.err;
      EXPECT_FALSE(std::filesystem::exists(folder / "out/result.json")) << name;
    }
    const auto result = folder / "out/result.json";
    if (verdict == "yes" && feature == "exact landmarks" && std::filesystem::exists(result)) {
      EXPECT_LT(testing::read_result(output())["landmarks"]["max_error_mm"], 1e-9 * 64) << name;
    }
  }
}

TEST_F(RegisterCombinations, EveryTransformTakesEveryMetric) {
  for (const std::string& transform : transforms_of(read_table())) {
    for (const char* metric : {"ssd", "ncc", "lncc", "mi", "nmi"}) {
      expect_works(run_combination(transform, {"--metric", metric}),
                   message(transform, " with ", metric));
    }
  }
}

}  // namespace
}  // namespace crease
