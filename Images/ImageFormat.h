#pragma once

#include <filesystem>
#include <string_view>

#include "Images/PixelType.h"

namespace crease {

enum class ImageFormat { kPng, kJpeg, kTiff, kPgm, kDicom, kNifti, kMetaImage, kNrrd };

/// "PNG", "JPEG", "TIFF", "PGM", "DICOM", "NIfTI", "MetaImage", "NRRD".
std::string_view to_string(ImageFormat format);

/// The format that the file's name says, in upper or lower case: png; jpg, jpeg; tif, tiff; pgm; dcm,
/// dicom, ima; nii, nii.gz, hdr, img; mha, mhd; nrrd, nhdr. A file with another name, or none, is
/// recognised by its first bytes if it exists.
/// @throws FileError when neither tells; the message lists the formats.
ImageFormat image_format(const std::filesystem::path& path);

/// False for PNG, JPEG, TIFF and PGM: their pixels are taken as 1 x 1 mm at (0, 0), whatever
/// resolution for printing they name, and what is written to them loses its geometry.
bool has_spacing(ImageFormat format);

/// Whether files of the format can be written with such pixels.
bool can_write(ImageFormat format, PixelType type);

}  // namespace crease
