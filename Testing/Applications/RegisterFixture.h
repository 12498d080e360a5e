#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "Images/ImageFile.h"
#include "Registration/Phantoms/Phantom.h"
#include "Testing/Applications/CommandRunner.h"
#include "Testing/TemporaryFolder.h"

namespace crease::testing {

/// Small images of a phantom without bodies on disk, and a short way to register them.
class RegisterFixture : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    images_ = std::make_unique<TemporaryFolder>();
    PhantomOptions options;
    options.size = 64;
    const Phantom phantom = make_phantom("blobs", options);
    write_image(*images_ / "fixed.mha", phantom.fixed, PixelType::kFloat);
    write_image(*images_ / "moving.mha", phantom.moving, PixelType::kFloat);
    write_displacement_field(*images_ / "truth.mha", phantom.displacement);
  }
  static void TearDownTestSuite() { images_.reset(); }

  static std::string image(const std::string& name) { return (*images_ / name).string(); }
  std::string output() const { return (folder / "out").string(); }

  /// `crease register` of the two images with a coarse mesh.
  CommandResult run(const std::vector<std::string>& extra = {}) const {
    return run_with(image("fixed.mha"), image("moving.mha"), extra);
  }
  CommandResult run_with(const std::string& fixed, const std::string& moving,
                         const std::vector<std::string>& extra) const {
    std::vector<std::string> arguments = {"register", "--fixed", fixed,    "--moving", moving,
                                          "--output", output(),  "--init", "identity", "--quiet"};
    const auto has = [&](const char* name) {
      return std::find(extra.begin(), extra.end(), name) != extra.end();
    };
    if (has("--init")) arguments.erase(arguments.end() - 3, arguments.end() - 1);
    const bool is_affine = has("affine") || has("similarity") || has("rigid");
    if (!has("--mesh-size") && !has("--triangles") && !is_affine) {
      arguments.insert(arguments.end(), {"--mesh-size", "16"});
    }
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return run_crease(arguments);
  }

  /// The result.json of a run that must succeed.
  nlohmann::json registered(const std::vector<std::string>& extra) const {
    const auto finished = run(extra);
    EXPECT_EQ(finished.code, 0) << finished.err;
    return read_result(output());
  }

  /// Expects that code, one line on the error stream with these texts, and no result.
  void expect_refused(const CommandResult& run, int code,
                      const std::vector<std::string>& texts) const {
    EXPECT_EQ(run.code, code) << run.err;
    EXPECT_THAT(run.err, ::testing::StartsWith("crease register: "));
    for (const auto& text : texts) EXPECT_THAT(run.err, ::testing::HasSubstr(text));
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "out/result.json"));
  }

  TemporaryFolder folder;

 private:
  static inline std::unique_ptr<TemporaryFolder> images_;
};

}  // namespace crease::testing
