#include "Images/ImageFormat.h"

#include <array>
#include <cctype>

#include "Core/Error.h"
#include "Images/Files/FileBytes.h"

namespace crease {
namespace {

struct Extension {
  std::string_view text;
  ImageFormat format;
};

constexpr std::array kExtensions{
    Extension{".png", ImageFormat::kPng},       Extension{".jpg", ImageFormat::kJpeg},
    Extension{".jpeg", ImageFormat::kJpeg},     Extension{".tif", ImageFormat::kTiff},
    Extension{".tiff", ImageFormat::kTiff},     Extension{".pgm", ImageFormat::kPgm},
    Extension{".dcm", ImageFormat::kDicom},     Extension{".dicom", ImageFormat::kDicom},
    Extension{".ima", ImageFormat::kDicom},     Extension{".nii", ImageFormat::kNifti},
    Extension{".nii.gz", ImageFormat::kNifti},  Extension{".hdr", ImageFormat::kNifti},
    Extension{".hdr.gz", ImageFormat::kNifti},  Extension{".img", ImageFormat::kNifti},
    Extension{".img.gz", ImageFormat::kNifti},  Extension{".mha", ImageFormat::kMetaImage},
    Extension{".mhd", ImageFormat::kMetaImage}, Extension{".nrrd", ImageFormat::kNrrd},
    Extension{".nhdr", ImageFormat::kNrrd}};

/// The format of a file that begins with these bytes; kPng with `known` false if none.
ImageFormat format_of_content(Bytes bytes, bool& known) {
  const ByteReader reader(bytes, false);
  known = true;
  if (reader.text(0, 4) == "\x89PNG") return ImageFormat::kPng;
  if (reader.text(0, 3) == "\xff\xd8\xff") return ImageFormat::kJpeg;
  if (reader.text(0, 4) == std::string_view("II*\0", 4)) return ImageFormat::kTiff;
  if (reader.text(0, 4) == std::string_view("MM\0*", 4)) return ImageFormat::kTiff;
  if (reader.text(0, 2) == "P5" || reader.text(0, 2) == "P2") return ImageFormat::kPgm;
  if (reader.text(128, 4) == "DICM") return ImageFormat::kDicom;
  if (reader.text(344, 3) == "n+1") return ImageFormat::kNifti;
  if (reader.text(0, 7) == "NRRD000") return ImageFormat::kNrrd;
  if (reader.text(0, 10) == "ObjectType") return ImageFormat::kMetaImage;
  known = false;
  return ImageFormat::kPng;
}

}  // namespace

std::string_view to_string(ImageFormat format) {
  constexpr std::array<std::string_view, 8> kNames{"PNG",   "JPEG",  "TIFF",      "PGM",
                                                   "DICOM", "NIfTI", "MetaImage", "NRRD"};
  return kNames[static_cast<std::size_t>(format)];
}

std::string_view to_string(PixelType type) {
  constexpr std::array<std::string_view, 10> kNames{"uint8", "int8",   "uint16", "int16", "uint32",
                                                    "int32", "uint64", "int64",  "float", "double"};
  return kNames[static_cast<std::size_t>(type)];
}

int bytes_per_value(PixelType type) {
  return with_pixel_type(type, [](auto zero) { return static_cast<int>(sizeof zero); });
}

ImageFormat image_format(const std::filesystem::path& path) {
  std::string name = path.filename().string();
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const Extension& extension : kExtensions) {
    if (name.size() > extension.text.size() && name.ends_with(extension.text)) {
      return extension.format;
    }
  }
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) {
    bool known = false;
    const auto format = format_of_content(read_bytes(path, 400), known);
    if (known) return format;
  }
  fail(path,
       "the image format is not known; known are .png, .jpg, .tif, .pgm, .dcm, .nii, .nii.gz, "
       ".mha, .mhd and .nrrd");
}

bool has_spacing(ImageFormat format) {
  return format == ImageFormat::kDicom || format == ImageFormat::kNifti ||
         format == ImageFormat::kMetaImage || format == ImageFormat::kNrrd;
}

bool can_write(ImageFormat format, PixelType type) {
  switch (format) {
    case ImageFormat::kPng:
    case ImageFormat::kPgm:
      return type == PixelType::kUint8 || type == PixelType::kUint16;
    case ImageFormat::kJpeg:
      return type == PixelType::kUint8;
    case ImageFormat::kTiff:
      return type == PixelType::kUint8 || type == PixelType::kUint16 || type == PixelType::kInt16 ||
             type == PixelType::kFloat;
    case ImageFormat::kDicom:
      return false;
    case ImageFormat::kNifti:
    case ImageFormat::kMetaImage:
    case ImageFormat::kNrrd:
      return true;
  }
  return false;
}

}  // namespace crease
