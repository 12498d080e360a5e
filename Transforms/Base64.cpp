#include "Transforms/Base64.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace crease {
namespace {

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::string encode(const std::vector<std::uint8_t>& bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - at);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < count ? bytes[at + k] : 0);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? kDigits[group >> (18 - 6 * k) & 63] : '=';
    }
  }
  return text;
}

std::optional<std::vector<std::uint8_t>> decode(std::string_view text) {
  static const auto values = [] {
    std::array<int, 256> table;
    table.fill(-1);
    for (int d = 0; d < 64; ++d) table[static_cast<std::uint8_t>(kDigits[d])] = d;
    return table;
  }();
  if (text.size() % 4 != 0) return std::nullopt;
  const std::size_t padding =
      text.ends_with("==") ? 2 : static_cast<std::size_t>(text.ends_with('='));
  std::vector<std::uint8_t> bytes;
  bytes.reserve(text.size() / 4 * 3);
  for (std::size_t at = 0; at < text.size(); at += 4) {
    const std::size_t digits = at + 4 == text.size() ? 4 - padding : 4;
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const int value = k < digits ? values[static_cast<std::uint8_t>(text[at + k])] : 0;
      if (value < 0) return std::nullopt;
      group = group << 6 | static_cast<std::uint32_t>(value);
    }
    for (std::size_t k = 0; k + 1 < digits; ++k) {
      bytes.push_back(static_cast<std::uint8_t>(group >> (16 - 8 * k)));
    }
  }
  return bytes;
}

template <typename Bits>
void append(std::vector<std::uint8_t>& bytes, Bits bits) {
  for (std::size_t k = 0; k < sizeof(Bits); ++k) {
    bytes.push_back(static_cast<std::uint8_t>(bits >> (8 * k)));
  }
}

template <typename Bits, typename Number>
std::optional<std::vector<double>> numbers_of(const std::vector<std::uint8_t>& bytes) {
  if (bytes.size() % sizeof(Bits) != 0) return std::nullopt;
  std::vector<double> numbers(bytes.size() / sizeof(Bits));
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    Bits bits = 0;
    for (std::size_t k = sizeof(Bits); k-- > 0;) bits = bits << 8 | bytes[n * sizeof(Bits) + k];
    numbers[n] = std::bit_cast<Number>(bits);
  }
  return numbers;
}

}  // namespace

EncodedNumbers encode_numbers(std::span<const double> numbers) {
  const bool single = std::ranges::all_of(numbers, [](double x) {
    return std::abs(x) <= std::numeric_limits<float>::max() && static_cast<float>(x) == x;
  });
  std::vector<std::uint8_t> bytes;
  bytes.reserve(numbers.size() * (single ? 4 : 8));
  for (const double x : numbers) {
    if (single) {
      append(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(x)));
    } else {
      append(bytes, std::bit_cast<std::uint64_t>(x));
    }
  }
  return {single ? "float32" : "float64", encode(bytes)};
}

std::optional<std::vector<double>> decode_numbers(std::string_view type, std::string_view text) {
  const auto bytes = decode(text);
  if (!bytes) return std::nullopt;
  if (type == "float32") return numbers_of<std::uint32_t, float>(*bytes);
  if (type == "float64") return numbers_of<std::uint64_t, double>(*bytes);
  return std::nullopt;
}

}  // namespace crease
