#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "Core/WholeFile.h"
#include "Images/Files/FileBytes.h"
#include "Images/Files/FileChecks.h"
#include "Images/Files/ItkImageFile.h"
#include "Images/Files/PortableGraymap.h"
#include "Images/ImageFile.h"
#include "Images/PngEncoder.h"
#include "Images/RasterCheck.h"

namespace crease {
namespace {

/// The value rounded and clamped to the type's range.
template <typename T>
T rounded(double value) {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<T>(value);
  } else {
    using Limits = std::numeric_limits<T>;
    if (value <= static_cast<double>(Limits::lowest())) return Limits::lowest();
    if (value >= static_cast<double>(Limits::max())) return Limits::max();
    return static_cast<T>(std::round(value));
  }
}

/// The parts of a file but for its pixels.
template <int Dim>
RawImage raw_header(const Raster<Dim>& raster, ImageFormat format, PixelType type,
                    int num_components) {
  RawImage raw;
  raw.size.assign(raster.size.begin(), raster.size.end());
  raw.set_plain_geometry(Dim);
  if (has_spacing(format)) {
    raw.spacing.assign(raster.spacing.begin(), raster.spacing.end());
    raw.origin.assign(raster.origin.begin(), raster.origin.end());
    raw.direction.assign(raster.direction.data(), raster.direction.data() + Dim * Dim);
  }
  raw.type = type;
  raw.num_components = num_components;
  return raw;
}

/// Keeps the pixels no longer than it must: files are looked through without them.
void write_raw(const std::filesystem::path& path, ImageFormat format, RawImage raw) {
  write_whole_file(path, [&](const std::filesystem::path& temporary) {
    auto name = temporary.filename().string();
    if (format == ImageFormat::kNifti) {  // ITK knows its name in small letters only
      std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
    }
    const auto plain = temporary.parent_path() / name;
    if (format == ImageFormat::kPgm) {
      write_pgm(plain, raw);
    } else {
      write_with_itk(plain, format, raw);
    }
    raw.data.reset();
    try {
      check_file(plain, format);
    } catch (const FileError&) {
      fail(path, "only a part of the file could be written; is the disk full?");
    }
    if (plain != temporary) std::filesystem::rename(plain, temporary);
  });
}

ImageFormat format_for_writing(const std::filesystem::path& path, int dimension, PixelType type) {
  const ImageFormat format = image_format(path);
  if (format == ImageFormat::kDicom) {
    throw InvalidInput(message(path.string(), ": DICOM files are only read; write .mha instead"));
  }
  if (!can_write(format, type)) {
    throw InvalidInput(message(path.string(), ": ", to_string(format), " files do not hold ",
                               to_string(type), " pixels; write .mha instead"));
  }
  const bool flat =
      format == ImageFormat::kPng || format == ImageFormat::kJpeg || format == ImageFormat::kPgm;
  if (flat && dimension != 2) {
    throw InvalidInput(message(path.string(), ": ", to_string(format),
                               " files hold images of 2 dimensions; write .mha instead"));
  }
  return format;
}

template <typename Pixel, int Dim, typename Convert>
void write_converted(const std::filesystem::path& path, const Image<Pixel, Dim>& image,
                     PixelType type, Convert&& value_of) {
  check_raster(image.raster(), path.string());
  const ImageFormat format = format_for_writing(path, Dim, type);
  RawImage raw = raw_header(image.raster(), format, type, 1);
  raw.allocate();
  with_pixel_type(type, [&](auto zero) {
    using T = decltype(zero);
    T* to = raw.values<T>();
    for (const Pixel& pixel : image.values()) *to++ = rounded<T>(value_of(pixel));
  });
  write_raw(path, format, std::move(raw));
}

bool is_whole(PixelType type) { return type != PixelType::kFloat && type != PixelType::kDouble; }

}  // namespace

template <typename Pixel, int Dim>
void write_image(const std::filesystem::path& path, const Image<Pixel, Dim>& image,
                 PixelType type) {
  if constexpr (std::is_floating_point_v<Pixel>) {
    if (is_whole(type)) {
      const auto nan = std::ranges::find_if(image.values(), [](Pixel v) { return std::isnan(v); });
      if (nan != image.values().end()) {
        throw InvalidInput(message(path.string(), ": a pixel is not a number, which ",
                                   to_string(type), " cannot hold; write float or replace it"));
      }
    }
  }
  write_converted(path, image, type, [](Pixel v) { return static_cast<double>(v); });
}

template <int Dim>
void write_mask(const std::filesystem::path& path, const Mask<Dim>& mask) {
  const double set = has_spacing(image_format(path)) ? 1 : 255;
  write_converted(path, mask, PixelType::kUint8,
                  [set](std::uint8_t v) { return v != 0 ? set : 0; });
}

template <int Dim>
void write_labels(const std::filesystem::path& path, const LabelImage<Dim>& labels) {
  std::int32_t largest = 0;
  for (const std::int32_t label : labels.values()) {
    if (label < 0) {
      throw InvalidInput(
          message(path.string(), ": a label is ", label, "; labels are not negative"));
    }
    largest = std::max(largest, label);
  }
  const PixelType type = largest < 256     ? PixelType::kUint8
                         : largest < 65536 ? PixelType::kUint16
                                           : PixelType::kInt32;
  write_converted(path, labels, type, [](std::int32_t v) { return static_cast<double>(v); });
}

template <int Dim>
void write_displacement_field(const std::filesystem::path& path,
                              const DisplacementField<Dim>& field, PixelType type) {
  check_raster(field.raster(), path.string());
  const ImageFormat format = format_for_writing(path, Dim, type);
  if (!has_spacing(format) || is_whole(type)) {
    throw InvalidInput(message(path.string(),
                               ": displacement fields are written as float or double "
                               "to .mha, .nii.gz or .nrrd"));
  }
  RawImage raw = raw_header(field.raster(), format, type, Dim);
  raw.allocate();
  with_pixel_type(type, [&](auto zero) {
    using T = decltype(zero);
    T* to = raw.values<T>();
    for (const Vector<Dim>& u : field.values()) {
      for (int a = 0; a < Dim; ++a) *to++ = rounded<T>(u[a]);
    }
  });
  write_raw(path, format, std::move(raw));
}

void write_rgb_png(const std::filesystem::path& path, int width, int height,
                   std::span<const std::uint8_t> bytes) {
  if (image_format(path) != ImageFormat::kPng) {
    throw InvalidInput(message(path.string(), ": pictures are written as .png"));
  }
  write_whole_file(path, encode_png(width, height, 3, bytes));
}

#define CREASE_INSTANTIATE_PIXEL(Pixel, Dim)                                                    \
  template void write_image<Pixel, Dim>(const std::filesystem::path&, const Image<Pixel, Dim>&, \
                                        PixelType);
#define CREASE_INSTANTIATE(Dim)                                                          \
  CREASE_INSTANTIATE_PIXEL(float, Dim)                                                   \
  CREASE_INSTANTIATE_PIXEL(double, Dim)                                                  \
  CREASE_INSTANTIATE_PIXEL(std::uint8_t, Dim)                                            \
  CREASE_INSTANTIATE_PIXEL(std::int32_t, Dim)                                            \
  template void write_mask<Dim>(const std::filesystem::path&, const Mask<Dim>&);         \
  template void write_labels<Dim>(const std::filesystem::path&, const LabelImage<Dim>&); \
  template void write_displacement_field<Dim>(const std::filesystem::path&,              \
                                              const DisplacementField<Dim>&, PixelType);

CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)

}  // namespace crease
