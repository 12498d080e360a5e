#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "Testing/Applications/CommandFixture.h"

namespace crease::testing {

/// A small phantom whose whole image is the elastic body, true pairs on it, and a short way to register them.
class ElasticFixture : public CommandFixture {
 protected:
  ElasticFixture() : CommandFixture("elastic") {}

  static constexpr int kSize = 64;

  static void SetUpTestSuite() {
    files_ = std::make_unique<TemporaryFolder>();
    PhantomOptions options;
    options.size = kSize;
    options.noise = 0;
    const Phantom phantom = make_phantom("blobs", options);
    write_phantom(*files_, phantom);
    LabelImage<2> labels(phantom.fixed.raster());
    for (int j = 26; j < 38; ++j) {  // between the pairs
      for (int i = 26; i < 38; ++i) labels(i, j) = 1;
    }
    write_image(*files_ / "labels.mha", labels, PixelType::kUint8);
    files_->write("pairs.csv", pairs_of(phantom));
  }
  static void TearDownTestSuite() { files_.reset(); }

  /// A file of pairs, by rows of four coordinates.
  std::string pairs(const std::string& rows) const {
    return folder.write("pairs.csv", "fixed_x,fixed_y,moving_x,moving_y\n" + rows);
  }

  static std::string file(const std::string& name) { return (*files_ / name).string(); }

  /// `crease elastic` of the two images with a coarse mesh and few steps.
  CommandResult run(const std::vector<std::string>& extra = {}) const {
    return run_with(file("fixed.mha"), file("moving.mha"), extra);
  }
  CommandResult run_with(const std::string& fixed, const std::string& moving,
                         const std::vector<std::string>& extra) const {
    std::vector<std::string> arguments = {"elastic", "--fixed",  fixed,    "--moving",
                                          moving,    "--output", output(), "--quiet"};
    const auto add_default = [&](const char* name, const std::string& value) {
      if (std::ranges::find(extra, name) == extra.end()) {
        arguments.insert(arguments.end(), {name, value});
      }
    };
    add_default("--roi", "image");
    add_default("--pairs", file("pairs.csv"));
    add_default("--steps", "2");
    if (std::ranges::find(extra, "--no-refine") == extra.end()) add_default("--levels", "2");
    if (std::ranges::find(extra, "--mesh-size") == extra.end()) add_default("--triangles", "80");
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return run_crease(arguments);
  }

  /// The result.json of a run that must succeed.
  nlohmann::json registered(const std::vector<std::string>& extra = {}) const {
    return result_of(run(extra));
  }

 private:
  /// 16 true pairs.
  static std::string pairs_of(const Phantom& phantom) {
    std::ostringstream text;
    text << "fixed_x,fixed_y,moving_x,moving_y\n";
    for (int j : {6, 23, 40, 57}) {
      for (int i : {6, 23, 40, 57}) {
        const Point<2> x = phantom.fixed.raster().point({i, j});
        const Point<2> y = x + phantom.displacement(i, j);
        text << x[0] << ',' << x[1] << ',' << y[0] << ',' << y[1] << '\n';
      }
    }
    return text.str();
  }

  static inline std::unique_ptr<TemporaryFolder> files_;
};

}  // namespace crease::testing
