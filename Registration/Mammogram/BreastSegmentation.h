#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Core/Error.h"
#include "Images/Image.h"
#include "Registration/Mammogram/GreyHistogram.h"

namespace crease {

/// Where the chest wall lies as the picture is seen.
enum class ChestSide { kLeft, kRight };

std::string to_string(ChestSide side);
inline ChestSide opposite(ChestSide side) {
  return side == ChestSide::kLeft ? ChestSide::kRight : ChestSide::kLeft;
}

/// How the breast is told from film and labels. Lengths in mm.
struct BreastSegmentationOptions {
  /// Grey value that the breast exceeds, in the frame's image; unset: the histogram's valley.
  std::optional<double> threshold;
  double octagon_radius_mm = 2;  ///< of closing and opening
  double chest_band = 0.05;      ///< share of the width in which the sides are compared
  double label_fill = 0.85;      ///< share of its bounding box that a label fills
  double smallest_area = 0.03;   ///< of the frame
  double largest_area = 0.90;
  std::string name = "the image";  ///< for messages
};

/// The breast, the pectoral muscle included.
struct BreastSegmentation {
  Mask<2> mask;  ///< one component without holes, on the raster of the frame's image
  ChestSide side = ChestSide::kLeft;
  GreyHistogram histogram;  ///< empty when a mask was given
  double threshold = 0;     ///< the grey value used; 0 when a mask was given
  double area_mm2 = 0;
  bool cut_above = false;  ///< the breast goes on beyond the frame's upper edge
  bool cut_below = false;
  std::vector<std::string> notes;     ///< for the user
  std::vector<std::string> warnings;  ///< what the user should look at
};

/// There is no breast where one was expected. Holds what a picture of the grey values needs.
class NoBreastFound : public InvalidInput {
 public:
  NoBreastFound(const std::string& what, const GreyHistogram& grey_values)
      : InvalidInput(what), histogram(grey_values) {}
  GreyHistogram histogram;
};

/// Pixels above the threshold, or the histogram's valley, closed and opened by an octagon (beyond the frame there
/// is background for closing and breast for opening, so that nothing is lost at the chest wall), the largest
/// 4-connected component that touches the chest wall's side, its holes filled. Labels fall away because they do
/// not touch the breast; bright rectangles that do are cut off by wider openings, with a warning.
///
/// @param image  the frame's: bright tissue, pixels about square.
/// @throws NoBreastFound when the area is out of range or the breast does not touch exactly one vertical
/// side; the message says which, and how to do without the search.
BreastSegmentation segment_breast(const Image<float, 2>& image,
                                  const BreastSegmentationOptions& options = {});

/// A mask from elsewhere, held to the same rules: its largest component at the chest wall, holes filled.
/// @throws NoBreastFound as above.
BreastSegmentation segmentation_of_mask(const Mask<2>& mask,
                                        const BreastSegmentationOptions& options = {});

}  // namespace crease
