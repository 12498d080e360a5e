#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "Core/WholeFile.h"

namespace crease::testing {

/// A new empty folder that disappears with this object.
class TemporaryFolder {
 public:
  std::filesystem::path operator/(const std::string& name) const { return path() / name; }
  const std::filesystem::path& path() const { return folder_.path(); }
  /// Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& text) const {
    const auto file = path() / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file.string();
  }

 private:
  crease::TemporaryFolder folder_{std::filesystem::temp_directory_path()};
};

inline std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace crease::testing
