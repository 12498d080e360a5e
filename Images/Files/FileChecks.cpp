#include "Images/Files/FileChecks.h"

#include "Images/Files/JpegFile.h"
#include "Images/Files/PortableGraymap.h"

namespace crease {

void check_file(const std::filesystem::path& path, ImageFormat format) {
  switch (format) {
    case ImageFormat::kPng:
      return check_png(path);
    case ImageFormat::kJpeg:
      read_jpeg(path, true);
      return;
    case ImageFormat::kTiff:
      return check_tiff(path);
    case ImageFormat::kPgm:
      read_pgm(path, true);
      return;
    case ImageFormat::kDicom:
      check_dicom(path);
      return;
    case ImageFormat::kNifti:
      check_nifti(path);
      return;
    case ImageFormat::kMetaImage:
      return check_meta_image(path);
    case ImageFormat::kNrrd:
      return check_nrrd(path);
  }
}

}  // namespace crease
