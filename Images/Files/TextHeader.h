#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace crease {

/// One line of a text header, without what ends it; nothing when no whole line is left.
/// @param at  where the line begins; moved to the next one.
std::optional<std::string_view> next_line(std::string_view text, std::size_t& at);

std::string_view trimmed(std::string_view text);

/// What a text header says, by the names of its fields.
using HeaderFields = std::map<std::string, std::string, std::less<>>;
std::string value_of(const HeaderFields& fields, std::string_view key, const char* otherwise);

/// Numbers separated by white space in the text, no more than `limit`.
std::uint64_t count_words(std::string_view text, std::uint64_t limit);

/// The product of the whole numbers in the text; 0 when one of them is not a positive number or the
/// product exceeds 10^15.
std::uint64_t product_of_sizes(std::string_view text);

}  // namespace crease
