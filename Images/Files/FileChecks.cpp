#include "Images/Files/FileChecks.h"

#include "Images/Files/JpegFile.h"
#include "Images/Files/PortableGraymap.h"

namespace crease {

FileFacts check_file(const std::filesystem::path& path, ImageFormat format) {
  switch (format) {
    case ImageFormat::kPng:
      check_png(path);
      return {};
    case ImageFormat::kJpeg:
      read_jpeg(path, true);
      return {};
    case ImageFormat::kTiff:
      check_tiff(path);
      return {};
    case ImageFormat::kPgm:
      read_pgm(path, true);
      return {};
    case ImageFormat::kDicom:
      return {check_dicom(path).has_spacing};
    case ImageFormat::kNifti:
      check_nifti(path);
      return {.has_spacing = true};
    case ImageFormat::kMetaImage:
      return check_meta_image(path);
    case ImageFormat::kNrrd:
      return check_nrrd(path);
  }
  return {};
}

}  // namespace crease
