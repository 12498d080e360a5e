#pragma once

#include <cstdint>
#include <string>

namespace crease {

// How reports write numbers and names.

/// With a minus sign for a hyphen in front.
std::string with_sign(const std::string& text);
/// Four digits.
std::string short_text(double value);
/// With narrow spaces between the thousands.
std::string count_text(std::int64_t count);
/// Without its folder.
std::string file_name(const std::string& path);

}  // namespace crease
