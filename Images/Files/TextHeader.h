#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace crease {

/// One line of a text header, without what ends it; nothing when no whole line is left.
/// @param at  where the line begins; moved to the next one.
std::optional<std::string_view> next_line(std::string_view text, std::size_t& at);

std::string_view trimmed(std::string_view text);

/// Numbers separated by white space in the text, no more than `limit`.
std::uint64_t count_words(std::string_view text, std::uint64_t limit);

/// The product of the whole numbers in the text; 0 when one of them is not a positive number or the
/// product exceeds 10^15.
std::uint64_t product_of_sizes(std::string_view text);

}  // namespace crease
