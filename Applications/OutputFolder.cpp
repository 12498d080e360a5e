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

}  // namespace

void write_file(const fs::path& file, const std::function<void(const fs::path&)>& write) {
  const fs::path temporary = file.parent_path() / (kTemporaryPrefix + file.filename().string());
  try {
    write(temporary);
    fs::rename(temporary, file);
  } catch (const fs::filesystem_error& error) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw FileError(message(file.string(), ": cannot be written: ", error.code().message(),
                            "; check the folder's rights and the space left."));
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
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
  if (!error) {
    for (const auto& entry : fs::directory_iterator(folder_, error)) {
      if (entry.path().filename().string().starts_with(kTemporaryPrefix)) fs::remove(entry, error);
    }
  }
  if (error) {
    throw UsageError(message("--output ", folder_.string(),
                             ": an earlier result cannot be removed: ", error.message(), "."));
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
