#pragma once

#include <filesystem>

#include "Images/Files/RawImage.h"

namespace crease {

/// Reads any image file after checking it. Trailing axes of one pixel are dropped, so that the image has
/// 2 or 3 axes; the geometry is valid (positive spacing, orthonormal direction). Components stay as they
/// are in the file.
/// @throws FileError.
RawImage read_raw(const std::filesystem::path& path, bool with_pixels = true);

/// Turns colour into luminance and drops transparency, with notes.
/// @throws FileError when the components are no colours.
void make_grey(const std::filesystem::path& path, RawImage& image);

}  // namespace crease
