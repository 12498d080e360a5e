#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "Images/Image.h"
#include "Images/ImageFormat.h"

// Reading and writing images: PNG, JPEG, TIFF, PGM, DICOM (one file, also of several frames; reading
// only), NIfTI-1, MetaImage and NRRD.
//
// All readers: colour becomes luminance 0.299 R + 0.587 G + 0.114 B, transparency is ignored, and the
// notes say so. DICOM's slope and intercept are applied; MONOCHROME1 is turned round so that high values
// are bright. A last axis of one pixel does not count: DICOM slices are 2D. A slice that is not parallel to
// the patient's xy plane gets the coordinates within its own plane. Files that are missing, truncated
// or damaged are refused, never read in part.
// @throws FileError with the file's name, what is wrong and what to do.
//
// All writers: the file appears under a temporary name and is renamed when it is complete. Of all that an
// input file said only what is in the Image (pixels and raster) can reach an output.
// @throws FileError when the file cannot be written, InvalidInput when the format cannot hold the image.
namespace crease {

/// What a file says about its image, whatever its dimension.
struct ImageHeader {
  ImageFormat format = ImageFormat::kPng;
  int dimension = 0;  ///< 2 or 3; entries beyond it are 1 (size, spacing) or 0 (origin)
  std::array<int, 3> size{1, 1, 1};
  Vector<3> spacing = Vector<3>::Ones();        ///< mm
  Point<3> origin = Point<3>::Zero();           ///< mm
  Matrix<3> direction = Matrix<3>::Identity();  ///< column = axis
  PixelType pixel_type = PixelType::kFloat;     ///< in the file
  int num_components = 1;                       ///< values per pixel
  std::vector<std::string> notes;
};

/// The header and what the pixels are like.
struct ImageInfo {
  ImageHeader header;
  double minimum = 0;  ///< of the finite values
  double maximum = 0;
  std::int64_t num_not_finite = 0;  ///< NaN or infinite
};

/// An image and what its file said of it.
template <int Dim>
struct ReadImage {
  Image<float, Dim> image;
  ImageFormat format = ImageFormat::kPng;
  PixelType pixel_type = PixelType::kFloat;  ///< in the file
  bool spacing_known = false;                ///< the file tells it; otherwise it is taken as 1 mm
  std::vector<std::string> notes;            ///< for the user, such as "colour converted to grey"
};

ImageHeader read_image_header(const std::filesystem::path& path);
ImageInfo read_image_info(const std::filesystem::path& path);

/// Pixels that are not finite are read as they are: see check_finite.
template <int Dim>
ReadImage<Dim> read_image(const std::filesystem::path& path);

/// 1 where the file's pixels are above 0.
template <int Dim>
Mask<Dim> read_mask(const std::filesystem::path& path);

/// @throws FileError also when a pixel is negative, not whole or above 2^31 - 1; names the first one.
template <int Dim>
LabelImage<Dim> read_labels(const std::filesystem::path& path);

/// A field of vectors in mm with Dim components per sample, as ITK, elastix, plastimatch and ANTs write
/// it (MetaImage, NIfTI, NRRD; any real type).
template <int Dim>
DisplacementField<Dim> read_displacement_field(const std::filesystem::path& path);

/// Whole types: values are rounded and clamped to the type's range.
/// @throws InvalidInput also when a value for a whole type is NaN.
template <typename Pixel, int Dim>
void write_image(const std::filesystem::path& path, const Image<Pixel, Dim>& image, PixelType type);

/// 1 where the mask is set; 255 in formats without spacing, for viewers.
template <int Dim>
void write_mask(const std::filesystem::path& path, const Mask<Dim>& mask);

/// In the smallest of uint8, uint16 and int32 that holds all labels.
template <int Dim>
void write_labels(const std::filesystem::path& path, const LabelImage<Dim>& labels);

/// @param type  kDouble or kFloat.
template <int Dim>
void write_displacement_field(const std::filesystem::path& path,
                              const DisplacementField<Dim>& field,
                              PixelType type = PixelType::kDouble);

/// A picture: 3 bytes (red, green, blue) per pixel, rows from the top. encode_png() gives the bytes alone.
void write_rgb_png(const std::filesystem::path& path, int width, int height,
                   std::span<const std::uint8_t> bytes);

/// How many pixels are NaN or infinite, and the first of them.
template <int Dim>
struct NonFinitePixels {
  std::int64_t count = 0;
  std::array<int, Dim> first{};
};
template <int Dim>
NonFinitePixels<Dim> find_non_finite(const Image<float, Dim>& image);

/// @throws InvalidInput when there are such pixels: "NAME: 3 pixels are not finite, the first at index
/// (4, 7)".
template <int Dim>
void check_finite(const Image<float, Dim>& image, std::string_view name);

}  // namespace crease
