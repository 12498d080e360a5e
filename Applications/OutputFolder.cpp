#include "Applications/OutputFolder.h"

#include <fstream>
#include <system_error>
#include <utility>

#include "Applications/ExitCode.h"

namespace crease {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTemporaryPrefix = ".crease-unfinished-";

void write_bytes(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) {
    throw FileError(message(file.string(),
                            ": cannot be written; check the folder's rights and the space left."));
  }
}

/// Removes what a run that was killed left behind: half-written files, and folders of image writers.
void remove_unfinished(const fs::path& folder, std::error_code& error) {
  std::vector<fs::path> unfinished;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().filename().string().starts_with(".crease-")) unfinished.push_back(entry);
  }
  for (const fs::path& path : unfinished) fs::remove_all(path, error);
}

/// The text with the user's name of a file in place of the temporary one.
std::string with_own_name(std::string text, const fs::path& temporary, const fs::path& file) {
  if (const auto at = text.find(temporary.string()); at != std::string::npos) {
    text.replace(at, temporary.string().size(), file.string());
  }
  return text;
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

void write_file(const fs::path& file, const std::function<void(const fs::path&)>& write) {
  const fs::path temporary = file.parent_path() / (kTemporaryPrefix + file.filename().string());
  struct Remover {
    const fs::path& path;
    ~Remover() {
      std::error_code ignored;
      fs::remove(path, ignored);
    }
  } const remover{temporary};
  try {
    write(temporary);
    fs::rename(temporary, file);
  } catch (const fs::filesystem_error& error) {
    throw FileError(message(file.string(), ": cannot be written: ", error.code().message(),
                            "; check the folder's rights and the space left."));
  } catch (const InvalidInput& error) {
    throw InvalidInput(with_own_name(error.what(), temporary, file));
  } catch (const FileError& error) {
    throw FileError(with_own_name(error.what(), temporary, file));
  }
}

void write_text(const fs::path& file, const std::string& text) {
  write_file(file, [&](const fs::path& temporary) { write_bytes(temporary, text); });
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
  const fs::path probe = file(std::string(kTemporaryPrefix) + "probe");
  const bool writable = std::ofstream(probe).is_open();
  fs::remove(probe, error);
  if (!writable) {
    throw UsageError(message("--output ", folder_.string(),
                             ": nothing can be written there; check the folder's rights."));
  }
}

void OutputFolder::check_is_no_input(const std::string& name) const {
  std::error_code ignored;
  for (const std::string& input : inputs_) {
    if (fs::equivalent(input, file(name), ignored)) {
      throw UsageError(message("--output ", folder_.string(), ": its ", name,
                               " is an input of this run; choose another folder."));
    }
  }
}

void OutputFolder::write(const std::string& name,
                         const std::function<void(const fs::path&)>& write) const {
  check_is_no_input(name);
  const fs::path path = file(name);
  std::error_code ignored;
  fs::create_directories(path.parent_path(), ignored);
  write_file(path, write);
}

void OutputFolder::remove(const std::string& name) const {
  check_is_no_input(name);
  std::error_code ignored;
  fs::remove(file(name), ignored);
}

void OutputFolder::write_text(const std::string& name, const std::string& text) const {
  write(name, [&](const fs::path& temporary) { write_bytes(temporary, text); });
}

}  // namespace crease
