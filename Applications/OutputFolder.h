#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace crease {

/// Refuses a path that no file can be written to, before any work is done for it.
/// @throws UsageError naming the option when its folder does not exist or the path is a folder itself.
void check_output_file(const std::string& option, const std::filesystem::path& file);

/// The folder of one run's results. A folder with result.json is complete: opening it removes a
/// result.json and temporary files that an earlier run left, and finish() writes the new one last.
class OutputFolder {
 public:
  /// Makes the folder where it is missing.
  /// @param inputs  files that this run reads: they are never overwritten.
  /// @throws UsageError when the folder cannot be made or written to.
  explicit OutputFolder(std::filesystem::path folder, std::vector<std::string> inputs = {});

  std::filesystem::path file(const std::string& name) const { return folder_ / name; }
  /// @throws UsageError when the file is an input. @throws FileError when it cannot be written.
  void write(const std::string& name,
             const std::function<void(const std::filesystem::path& temporary)>& write) const;
  void write_text(const std::string& name, const std::string& text) const;
  /// Removes what an earlier run wrote and this one does not. @throws UsageError as above.
  void remove(const std::string& name) const;
  /// Removes files of this name with a number from `first` on, such as NAME-3.mha, whatever their ending; inputs of
  /// this run stay.
  void remove_numbered(const std::string& name, std::size_t first) const;
  void finish(const std::string& result_json) const { write_text("result.json", result_json); }

 private:
  bool is_input(const std::string& name) const;
  void check_is_no_input(const std::string& name) const;

  std::filesystem::path folder_;
  std::vector<std::string> inputs_;
};

}  // namespace crease
