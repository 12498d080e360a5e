#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace crease {

/// Numbers as text, all their bits kept: little-endian IEEE 754 in base64 (RFC 4648, padded). Single
/// precision where every number fits it exactly, else double.
struct EncodedNumbers {
  std::string type;  ///< "float32" or "float64"
  std::string text;
};
EncodedNumbers encode_numbers(std::span<const double> numbers);

/// @return empty when the text is no base64 of whole numbers of this type, or the type is unknown.
std::optional<std::vector<double>> decode_numbers(std::string_view type, std::string_view text);

}  // namespace crease
