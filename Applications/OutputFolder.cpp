#include "Applications/OutputFolder.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <system_error>
#include <utility>

#include "Applications/ExitCode.h"
#include "Core/WholeFile.h"

namespace crease {
namespace {

namespace fs = std::filesystem;

/// Removes what a run that was killed left behind: the folders of half-written files.
void remove_unfinished(const fs::path& folder, std::error_code& error) {
  std::vector<fs::path> unfinished;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (TemporaryFolder::is_one(entry.path())) unfinished.push_back(entry);
  }
  for (const fs::path& path : unfinished) fs::remove_all(path, error);
}

/// The number in a file's name "PREFIX3.mha", written without zeros before it.
std::optional<std::size_t> number_behind(const std::string& prefix, const std::string& file) {
  if (!file.starts_with(prefix)) return std::nullopt;
  const char* const begin = file.data() + prefix.size();
  const char* const end = file.data() + file.size();
  std::size_t number = 0;
  const auto [rest, error] = std::from_chars(begin, end, number);
  if (error != std::errc() || *begin == '0' || rest == end || *rest != '.') return std::nullopt;
  return number;
}

}  // namespace

void check_output_file(const std::string& option, const fs::path& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) {
    throw UsageError(message("--", option, " ", file.string(), ": this is a folder; name a file."));
  }
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored)) {
    throw UsageError(message("--", option, " ", file.string(), ": there is no folder ",
                             folder.string(), "; make it first."));
  }
}

OutputFolder::OutputFolder(fs::path folder, std::vector<std::string> inputs)
    : folder_(std::move(folder)), inputs_(std::move(inputs)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error || !fs::is_directory(folder_)) {
    throw UsageError(message("--output ", folder_.string(), ": the folder cannot be made: ",
                             error ? error.message() : "a file of that name exists", "."));
  }
  fs::remove(folder_ / "result.json", error);
  if (!error) remove_unfinished(folder_, error);
  if (!error && fs::is_directory(folder_ / "pictures")) {
    remove_unfinished(folder_ / "pictures", error);
  }
  if (error) {
    throw UsageError(message("--output ", folder_.string(),
                             ": an earlier result cannot be removed: ", error.message(), "."));
  }
  try {
    const TemporaryFolder probe(folder_);
  } catch (const fs::filesystem_error&) {
    throw UsageError(message("--output ", folder_.string(),
                             ": nothing can be written there; check the folder's rights."));
  }
}

bool OutputFolder::is_input(const std::string& name) const {
  return std::ranges::any_of(inputs_, [&](const std::string& input) {
    std::error_code ignored;
    return fs::equivalent(input, file(name), ignored);
  });
}

void OutputFolder::check_is_no_input(const std::string& name) const {
  if (!is_input(name)) return;
  throw UsageError(message("--output ", folder_.string(), ": its ", name,
                           " is an input of this run; choose another folder."));
}

void OutputFolder::write(const std::string& name,
                         const std::function<void(const fs::path&)>& write) const {
  check_is_no_input(name);
  const fs::path path = file(name);
  std::error_code ignored;
  fs::create_directories(path.parent_path(), ignored);
  write_whole_file(path, write);
}

void OutputFolder::remove(const std::string& name) const {
  check_is_no_input(name);
  std::error_code ignored;
  fs::remove(file(name), ignored);
}

void OutputFolder::remove_numbered(const std::string& name, std::size_t first) const {
  std::vector<std::string> earlier;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder_, ignored)) {
    const std::string file = entry.path().filename().string();
    const auto number = number_behind(name + "-", file);
    if (number && *number >= first && !is_input(file)) earlier.push_back(file);
  }
  for (const std::string& file : earlier) remove(file);
}

void OutputFolder::write_text(const std::string& name, const std::string& text) const {
  check_is_no_input(name);
  write_whole_file(file(name), text);
}

}  // namespace crease
