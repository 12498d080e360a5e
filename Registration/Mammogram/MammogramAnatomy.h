#pragma once

#include <optional>
#include <string>
#include <vector>

#include "Images/Image.h"
#include "Registration/Mammogram/BreastSegmentation.h"
#include "Registration/Mammogram/MammogramFrame.h"
#include "Registration/Mammogram/PectoralMuscle.h"
#include "Registration/Mammogram/SkinContour.h"
#include "Transforms/Domains/FeatureLine.h"

namespace crease {

/// Whether the pectoral muscle is searched for.
enum class PectoralSearch { kAuto, kNone };

struct MammogramOptions {
  std::string name = "the image";  ///< for messages, such as the file's name
  MammogramFrameOptions frame;
  BreastSegmentationOptions breast;
  PectoralSearch pectoral_search = PectoralSearch::kAuto;
  PectoralOptions pectoral;
  SkinContourOptions skin;
  std::optional<Mask<2>> mask;  ///< of the breast, on the image's pixels, instead of a threshold
  std::optional<double> threshold;  ///< grey value of the image that separates film and breast
  std::optional<Polyline> pectoral_line;  ///< instead of a search; mm in the image's geometry
  bool force = false;                     ///< goes on where contours are too short
};

/// What can be seen in one mammogram without another one. All points in mm (LPS), in the geometry of
/// `frame.raster`: the image's own, or, after `mirrored`, that of its mirror image.
struct MammogramAnatomy {
  MammogramFrame frame;
  BreastSegmentation breast;  ///< the mask is on the raster of `frame.image`
  SkinContour skin;
  std::optional<PectoralMuscle> pectoral;
  /// The breast: SkinContour::outline, closed along the frame, or straight where that would cross it.
  Polyline region;
  bool mirrored = false;              ///< left and right are swapped
  std::vector<std::string> notes;     ///< of all steps, for the user
  std::vector<std::string> warnings;  ///< of all steps: what the user should look at

  /// The skin line without what lies beyond the pectoral line.
  Polyline contour_below_pectoral() const;
  /// The pectoral line as a crease; none: empty.
  std::vector<FeatureLine> feature_lines() const;
  /// Takes a point of this geometry to where the image as given has it, mm: the identity unless mirrored. A
  /// transform of `mirrored` geometries followed by it maps into the original image.
  AffineMap<2> to_given() const;
};

/// Finds film, breast, skin line, nipple and pectoral muscle. Any range of grey values, any pixel size; about
/// 0.2 s for 4 million pixels.
/// @throws InvalidInput (NoBreastFound) with the reason and what to do.
MammogramAnatomy analyse_mammogram(const Image<float, 2>& image,
                                   const MammogramOptions& options = {});

/// The anatomy of the mirror image, left and right swapped within the film's frame. Mirrored twice it is as
/// before.
MammogramAnatomy mirrored(const MammogramAnatomy& anatomy);

/// Compares two views before they are registered; `moving` as it will be used, mirrored or not.
/// @returns warnings: the chest walls on different sides, a pectoral muscle in one view only; when forced also
/// what else would throw.
/// @throws InvalidInput unless forced, when the contours' lengths differ by more than 40 % of the shorter one.
std::vector<std::string> check_views(const MammogramAnatomy& fixed, const MammogramAnatomy& moving,
                                     bool force = false);

}  // namespace crease
