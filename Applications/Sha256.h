#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace crease {

/// SHA-256 of the bytes, as 64 hexadecimal digits. Source: FIPS 180-4.
std::string sha256(std::span<const std::byte> bytes);

/// The same of a file's content. @throws FileError when it cannot be read.
std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace crease
