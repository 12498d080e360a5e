#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "Images/ImageFile.h"
#include "Registration/Phantoms/Phantom.h"
#include "Testing/Applications/CommandRunner.h"
#include "Testing/TemporaryFolder.h"

namespace crease::testing {

/// A folder for the runs of one subcommand, and what is expected of them.
class CommandFixture : public ::testing::Test {
 protected:
  explicit CommandFixture(std::string command) : command_(std::move(command)) {}

  std::string output() const { return (folder / "out").string(); }

  /// The result.json of a run that must succeed.
  nlohmann::json result_of(const CommandResult& finished) const {
    EXPECT_EQ(finished.code, 0) << finished.err;
    return read_result(output());
  }

  /// Expects that code, one line on the error stream with these texts, and no result.
  void expect_refused(const CommandResult& run, int code,
                      const std::vector<std::string>& texts) const {
    EXPECT_EQ(run.code, code) << run.err;
    EXPECT_THAT(run.err, ::testing::StartsWith("crease " + command_ + ": "));
    for (const auto& text : texts) EXPECT_THAT(run.err, ::testing::HasSubstr(text));
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "out/result.json"));
  }

  /// Names of all files below a folder.
  static std::set<std::string> files_in(const std::filesystem::path& root) {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
      if (entry.is_regular_file()) {
        names.insert(std::filesystem::relative(entry.path(), root).string());
      }
    }
    return names;
  }

  /// fixed.mha, moving.mha and truth.mha.
  static void write_phantom(const TemporaryFolder& to, const Phantom& phantom) {
    write_image(to / "fixed.mha", phantom.fixed, PixelType::kFloat);
    write_image(to / "moving.mha", phantom.moving, PixelType::kFloat);
    write_displacement_field(to / "truth.mha", phantom.displacement);
  }

  TemporaryFolder folder;

 private:
  std::string command_;
};

}  // namespace crease::testing
