#pragma once

#include <cstdint>
#include <string_view>
#include <type_traits>
#include <utility>

namespace crease {

/// How a file stores a pixel's value.
enum class PixelType {
  kUint8,
  kInt8,
  kUint16,
  kInt16,
  kUint32,
  kInt32,
  kUint64,
  kInt64,
  kFloat,
  kDouble
};

/// "uint8", ..., "float", "double".
std::string_view to_string(PixelType type);

int bytes_per_value(PixelType type);

/// Calls f(T()) with the type that is meant.
template <typename Function>
decltype(auto) with_pixel_type(PixelType type, Function&& f) {
  // NOLINTBEGIN(bugprone-branch-clone): branches differ in the type
  switch (type) {
    case PixelType::kUint8:
      return f(std::uint8_t());
    case PixelType::kInt8:
      return f(std::int8_t());
    case PixelType::kUint16:
      return f(std::uint16_t());
    case PixelType::kInt16:
      return f(std::int16_t());
    case PixelType::kUint32:
      return f(std::uint32_t());
    case PixelType::kInt32:
      return f(std::int32_t());
    case PixelType::kUint64:
      return f(std::uint64_t());
    case PixelType::kInt64:
      return f(std::int64_t());
    case PixelType::kFloat:
      return f(float());
    case PixelType::kDouble:
      break;
  }
  // NOLINTEND(bugprone-branch-clone)
  return f(double());
}

}  // namespace crease
