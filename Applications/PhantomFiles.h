#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "Applications/OutputFolder.h"

namespace crease {

/// Writes the files of `crease phantom` and remembers their names.
class PhantomFiles {
 public:
  using Path = std::filesystem::path;
  explicit PhantomFiles(const std::string& folder) : output_(folder) {}

  void write(const std::string& name, const std::function<void(const Path&)>& writer) {
    output_.write(name, writer);
    names_.push_back(name);
  }
  void write_text(const std::string& name, const std::string& text) {
    output_.write_text(name, text);
    names_.push_back(name);
  }
  const OutputFolder& output() const { return output_; }
  const std::vector<std::string>& names() const { return names_; }

 private:
  OutputFolder output_;
  std::vector<std::string> names_;
};

}  // namespace crease
