#pragma once

#include <filesystem>

#include "Images/Files/RawImage.h"

// Netpbm's grey images: P5 (binary) and P2 (text), of 8 or 16 bits; 16-bit numbers are big-endian.
// @throws FileError.
namespace crease {

/// Values are those of the file, not scaled to its largest value.
RawImage read_pgm(const std::filesystem::path& path, bool with_pixels);

/// Writes P5. The image is 2D, uint8 or uint16.
void write_pgm(const std::filesystem::path& path, const RawImage& image);

}  // namespace crease
