#pragma once

#include <filesystem>

#include "Images/Files/RawImage.h"

// Image files by ITK's I/O classes. The files have been checked before (FileChecks.h).
// @throws FileError.
namespace crease {

/// @param with_pixels  false: only the header.
RawImage read_with_itk(const std::filesystem::path& path, ImageFormat format, bool with_pixels);

/// Writes pixels and geometry, nothing else, in the format that is given.
void write_with_itk(const std::filesystem::path& path, ImageFormat format, const RawImage& image);

}  // namespace crease
