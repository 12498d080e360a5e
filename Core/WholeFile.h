#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace crease {

/// A new folder `.crease-...` within `parent`, removed with all that is in it when the object goes.
class TemporaryFolder {
 public:
  /// @throws std::filesystem::filesystem_error when nothing can be written there.
  explicit TemporaryFolder(const std::filesystem::path& parent);
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();
  const std::filesystem::path& path() const { return path_; }
  /// Whether a path is such a folder: one that is not in use was left by a process that was killed.
  static bool is_one(const std::filesystem::path& path);

 private:
  std::filesystem::path path_;
};

/// Lets `write` make a file of the same name in a temporary folder beside `path`, then moves all that it
/// made (a header may come with its pixels) into place, the file itself last. Whoever looks at `path`
/// finds the old file or the whole new one; if writing fails nothing is left behind, and what `write`
/// throws speaks of `path`.
/// @throws FileError when the folder does not exist or cannot be written to.
void write_whole_file(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

/// The same for a text.
void write_whole_file(const std::filesystem::path& path, const std::string& text);

}  // namespace crease
