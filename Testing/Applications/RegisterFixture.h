#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "Testing/Applications/CommandFixture.h"

namespace crease::testing {

/// Small images of a phantom without bodies on disk, and a short way to register them.
class RegisterFixture : public CommandFixture {
 protected:
  RegisterFixture() : CommandFixture("register") {}

  static void SetUpTestSuite() {
    images_ = std::make_unique<TemporaryFolder>();
    PhantomOptions options;
    options.size = 64;
    const Phantom phantom = make_phantom("blobs", options);
    write_phantom(*images_, phantom);
  }
  static void TearDownTestSuite() { images_.reset(); }

  static std::string image(const std::string& name) { return (*images_ / name).string(); }

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
    return result_of(run(extra));
  }

 private:
  static inline std::unique_ptr<TemporaryFolder> images_;
};

}  // namespace crease::testing
