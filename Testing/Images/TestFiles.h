#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "Testing/TemporaryFolder.h"

namespace crease::testing {

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::remove(path);  // file systems may wait for the disk when a file is shortened
  std::ofstream(path, std::ios::binary) << text;
}

/// A file of the optional test data.
inline std::filesystem::path shared_file(const std::string& name) {
  return std::filesystem::path(CREASE_SHARED_DIR) / "data" / name;
}

}  // namespace crease::testing

/// Leaves a test that needs a file of the optional test data if it is not there.
#define CREASE_NEEDS(name)                                                 \
  if (!std::filesystem::exists(crease::testing::shared_file(name))) {      \
    GTEST_SKIP() << crease::testing::shared_file(name) << " is not there"; \
  }
