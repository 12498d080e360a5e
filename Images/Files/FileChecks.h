#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "Images/ImageFormat.h"

// The libraries that decode image files accept truncated ones in silence, or end the process when a
// file is damaged. So every file is looked through first: is it what its name says, is its structure
// whole, and does it hold all bytes that its header promises?
// @throws FileError with the file's name and what is wrong.
namespace crease {

void check_png(const std::filesystem::path& path);
void check_tiff(const std::filesystem::path& path);

/// ITK's reader silently turns values that are not finite into zeros.
struct NiftiFacts {
  struct Value {
    std::int64_t position = 0;  ///< among the values of the file, component by component
    double value = 0;           ///< NaN or infinite
  };
  std::vector<Value> not_finite;
};
NiftiFacts check_nifti(const std::filesystem::path& path);

/// What a header says besides what ITK tells.
struct FileFacts {
  bool has_spacing = false;  ///< otherwise ITK takes 1 mm
};
FileFacts check_meta_image(const std::filesystem::path& path);
FileFacts check_nrrd(const std::filesystem::path& path);

/// What the reader of DICOM files has to know besides what ITK tells.
struct DicomFacts {
  bool monochrome1 = false;  ///< stored upside down: low values are bright
  bool has_spacing = false;  ///< otherwise ITK takes 1 mm
};
DicomFacts check_dicom(const std::filesystem::path& path);

/// The right one of the above; PGM and JPEG files are checked by reading them.
/// NIfTI files always have a spacing.
FileFacts check_file(const std::filesystem::path& path, ImageFormat format);

}  // namespace crease
