#pragma once

#include <span>
#include <string>
#include <string_view>

namespace crease {

/// Insertions, deletions, replacements and swaps of neighbours that turn one word into the other.
/// Source: optimal string alignment distance; Damerau, Comm. ACM 7(3), 1964.
int edit_distance(std::string_view a, std::string_view b);

/// The candidate with the smallest edit distance to the word, the first of several; empty when none is
/// near: farther than a third of the longer word, at least 2.
std::string nearest_word(std::string_view word, std::span<const std::string> candidates);

/// "a, b or c".
std::string one_of(std::span<const std::string> words);

}  // namespace crease
