#pragma once

#include <filesystem>
#include <string>

namespace crease {

/// Writes a text under a temporary name beside the file and renames it when it is whole: a file under its
/// own name is always complete. When that fails, nothing is left behind.
/// @throws FileError when it cannot be written.
void write_whole_file(const std::filesystem::path& file, const std::string& text);

}  // namespace crease
