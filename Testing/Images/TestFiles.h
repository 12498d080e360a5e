#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace crease::testing {

/// A folder of its own for the files of one test.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "crease-test-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

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
