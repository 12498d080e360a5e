#include "Images/Files/FileChecks.h"

#include "Images/Files/JpegFile.h"
#include "Images/Files/PortableGraymap.h"

namespace crease {

bool check_file(const std::filesystem::path& path, ImageFormat format) {
  switch (format) {
    case ImageFormat::kPng:
      check_png(path);
      return false;
    case ImageFormat::kJpeg:
      read_jpeg(path, true);
      return false;
    case ImageFormat::kTiff:
      check_tiff(path);
      return false;
    case ImageFormat::kPgm:
      read_pgm(path, true);
      return false;
    case ImageFormat::kDicom:
      return check_dicom(path).has_spacing;
    case ImageFormat::kNifti:
      check_nifti(path);
      return true;
    case ImageFormat::kMetaImage:
      return check_meta_image(path);
    case ImageFormat::kNrrd:
      return check_nrrd(path);
  }
  return false;
}

}  // namespace crease
