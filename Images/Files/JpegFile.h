#pragma once

#include <filesystem>

#include "Images/Files/RawImage.h"

namespace crease {

/// Reads a grey or colour JPEG file by libjpeg: ITK's reader takes truncated files for whole ones and
/// ends the process on damaged ones.
/// @throws FileError.
RawImage read_jpeg(const std::filesystem::path& path, bool with_pixels);

}  // namespace crease
