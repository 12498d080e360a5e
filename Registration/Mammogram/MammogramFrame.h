#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "Images/Image.h"
#include "Transforms/AffineMap.h"

namespace crease {

/// How a mammogram is made ready for the search for the breast. Lengths in mm.
struct MammogramFrameOptions {
  std::optional<double> pixel_size_mm;  ///< of both axes; unset: what the image says
  /// False: the image says nothing (ReadImage::spacing_known). Then 0.2 mm, the pixel of the mini-MIAS database,
  /// is assumed.
  bool spacing_known = true;
  double working_pixel_mm = 0.2;  ///< of the resampled image
  double scanner_line_mm = 0.6;   ///< wider bright bands along the frame's edge are not cut off
  double padding_share = 0.01;  ///< rows and columns of the film have more pixels above the padding
  int smallest = 128;           ///< pixels per axis
  int largest = 8192;           ///< pixels per axis of the resampled image; more are reduced
  std::string name = "the image";  ///< for messages, such as the file's name
};

/// The film within an image, bright on dark, resampled to the pixels that all later steps work on.
///
/// Databases pad films with zeros (mini-MIAS to a square), so the chest wall may lie inside the image:
/// wherever a later step speaks of the image's border it means the frame's.
struct MammogramFrame {
  Raster<2> raster;            ///< of the image as given, its pixel size mended
  bool inverted = false;       ///< the image shows dense tissue dark: v stands for value_sum - v
  double value_sum = 0;        ///< smallest + largest value of the image
  std::array<int, 2> first{};  ///< the frame's first pixel in the image
  std::array<int, 2> size{};   ///< the frame's pixels per axis
  Image<float, 2> image;  ///< the frame, resampled by area average, grey values as in the image
  std::vector<std::string> notes;  ///< for the user

  /// Swaps left and right within the frame: a point of `raster` to where its mirror image lies, mm. Its own
  /// inverse.
  AffineMap<2> reflection() const;
};

/// Finds the film and whether it is a negative.
///
/// Negative: the median of the image's border band exceeds that of its centre, or, where both show the
/// background, lies in the upper half of the grey values. Frame: the rows and columns with more than 1 % of
/// pixels above the image's smallest value, less bright lines of the scanner along the edges.
/// @throws InvalidInput for images with pixels that are not finite, that are too small, or all equal, and for
/// pixel sizes that are not positive.
MammogramFrame find_frame(const Image<float, 2>& image, const MammogramFrameOptions& options = {});

/// The frame seen in a mirror: the image's raster runs the other way (its direction matrix), so that the
/// pixels as stored keep their order, and the resampled image is turned round.
MammogramFrame mirrored(const MammogramFrame& frame);

/// The whole image as all later steps see it: bright tissue, on the frame's raster.
/// @throws InvalidInput when its size is not that of the image the frame was found in.
Image<float, 2> upright_image(Image<float, 2> image, const MammogramFrame& frame);

/// A mask of the whole image on the pixels of the frame's image: 1 where most of a pixel is set.
/// @throws InvalidInput when its size is not that of the image the frame was found in.
Mask<2> mask_in_frame(const Mask<2>& mask, const MammogramFrame& frame);

}  // namespace crease
