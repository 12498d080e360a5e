#include "Core/WholeFile.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>

#include "Core/Error.h"

namespace crease {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTemplate = ".crease-XXXXXX";  // the X are replaced by mkdtemp

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw FileError(message(path.string(), ": ", what));
}

/// @throws FileError when there is no folder to write the file to.
fs::path folder_of(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) fail(path, "this is a folder; name a file to write to");
  fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(parent, ignored)) {
    fail(path, message("the folder ", parent.string(), " does not exist; create it first"));
  }
  return parent;
}

/// The text with the user's name of a file in place of the temporary one.
std::string with_own_name(std::string text, const fs::path& temporary, const fs::path& path) {
  if (const auto at = text.find(temporary.string()); at != std::string::npos) {
    text.replace(at, temporary.string().size(), path.string());
  }
  return text;
}

void move_into_place(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) fail(to, message("the finished file cannot be put into place: ", error.message()));
}

}  // namespace

TemporaryFolder::TemporaryFolder(const fs::path& parent) {
  std::string name = (parent / kTemplate).string();
  if (mkdtemp(name.data()) == nullptr) {
    throw fs::filesystem_error(std::strerror(errno), parent,
                               std::error_code(errno, std::generic_category()));
  }
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

bool TemporaryFolder::is_one(const fs::path& path) {
  const std::string name = path.filename().string();
  std::error_code ignored;
  return name.size() == kTemplate.size() && name.starts_with(kTemplate.substr(0, 8)) &&
         fs::is_directory(path, ignored);
}

void write_whole_file(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  const fs::path parent = folder_of(path);
  std::optional<TemporaryFolder> folder;
  try {
    folder.emplace(parent);
  } catch (const fs::filesystem_error& error) {
    fail(path,
         message("nothing can be written to ", parent.string(), ": ", error.code().message()));
  }
  const fs::path temporary = folder->path() / path.filename();
  try {
    write(temporary);
  } catch (const InvalidInput& error) {
    throw InvalidInput(with_own_name(error.what(), temporary, path));
  } catch (const FileError& error) {
    throw FileError(with_own_name(error.what(), temporary, path));
  }
  for (const auto& entry : fs::directory_iterator(folder->path())) {
    if (entry.path() != temporary) {
      move_into_place(entry.path(), path.parent_path() / entry.path().filename());
    }
  }
  move_into_place(temporary, path);
}

void write_whole_file(const fs::path& path, const std::string& text) {
  write_whole_file(path, [&](const fs::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary);
    stream << text;
    stream.close();
    if (!stream)
      fail(temporary, "cannot be written; check the folder's rights and the space left.");
  });
}

}  // namespace crease
