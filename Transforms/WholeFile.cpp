#include "Transforms/WholeFile.h"

#include <fstream>
#include <system_error>

#include "Core/Error.h"

namespace crease {

void write_whole_file(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path temporary = file.string() + ".part";
  std::ofstream stream(temporary, std::ios::binary);
  stream << text;
  stream.close();
  std::error_code error;
  if (stream) std::filesystem::rename(temporary, file, error);
  if (stream && !error) return;
  std::error_code ignored;
  std::filesystem::remove(temporary, ignored);
  throw FileError(
      message(file.string(), ": cannot be written; check the folder's rights and the space left."));
}

}  // namespace crease
