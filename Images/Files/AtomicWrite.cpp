#include "Images/Files/AtomicWrite.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "Core/Error.h"
#include "Images/Files/FileBytes.h"

namespace crease {
namespace {

namespace fs = std::filesystem;

void move_into_place(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) fail(to, message("the finished file cannot be put into place: ", error.message()));
}

}  // namespace

TemporaryFolder::TemporaryFolder(const fs::path& parent) {
  std::string name = (parent / ".crease-XXXXXX").string();
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

void write_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) fail(path, "this is a folder; name a file to write to");
  const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(parent, ignored)) {
    fail(path, message("the folder ", parent.string(), " does not exist; create it first"));
  }
  std::optional<TemporaryFolder> holder;
  try {
    holder.emplace(parent);
  } catch (const fs::filesystem_error& error) {
    fail(path,
         message("nothing can be written to ", parent.string(), ": ", error.code().message()));
  }
  const TemporaryFolder& folder = *holder;
  const fs::path temporary = folder.path() / path.filename();
  try {
    write(temporary);
  } catch (const FileError& error) {  // speak of the file that the user named
    std::string text = error.what();
    if (const auto at = text.find(temporary.string()); at != std::string::npos) {
      text.replace(at, temporary.string().size(), path.string());
    }
    throw FileError(text);
  }
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    if (entry.path() != temporary) {
      move_into_place(entry.path(), path.parent_path() / entry.path().filename());
    }
  }
  move_into_place(temporary, path);
}

}  // namespace crease
