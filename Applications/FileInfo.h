#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace crease {

/// What is known about a file, for people and for programs.
struct FileInfo {  // NOLINT(bugprone-exception-escape): JSON's move does not throw
  nlohmann::ordered_json figures;
  std::string text;
};

/// As "1.5, 2": six digits at most.
std::string numbers_text(const double* values, int count, const char* separator);

/// What a transform file holds: its kind, mesh, degree and control points, and whether it is certified
/// to be invertible. @throws FileError when it is no transform file.
FileInfo transform_info(const std::string& file);

}  // namespace crease
