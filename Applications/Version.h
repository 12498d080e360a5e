#pragma once

#include <string>

namespace crease {

/// "0.1.0".
std::string version_number();

/// Version, build, the libraries in this program and its licence, over several lines.
std::string version_text();

}  // namespace crease
