#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "Images/Image.h"
#include "Registration/Landmarks.h"
#include "Registration/Phantoms/MammogramDucts.h"
#include "Transforms/Transform.h"

namespace crease {

/// From the side (mediolateral oblique), with the pectoral muscle, or from above (craniocaudal), without.
enum class MammogramView { kMlo, kCc };
/// Two mammograms of one breast at different times, or of the left and the right breast.
enum class MammogramPairKind { kTemporal, kBilateral };
/// The image that shows a mass.
enum class MammogramMassPlace { kNone, kFixed, kMoving };

/// What is drawn.
struct MammogramPhantomOptions {
  int size = 1024;  ///< pixels along each side of the frame of 204.8 mm, 128 to 4096
  std::uint64_t seed = 1;
  MammogramView view = MammogramView::kMlo;
  MammogramPairKind pair = MammogramPairKind::kTemporal;
  double density = 0.5;  ///< of the gland: 0 fatty, 1 dense
  double noise = 0.004;  ///< deviation of the pixel noise, greys being 0 to 1; 0 to 0.5
  int bits = 12;         ///< 8, 12 or 16 per pixel
  MammogramMassPlace mass = MammogramMassPlace::kNone;
  bool label = true;  ///< two bright rectangles on the film, away from the breast
  /// The motion is that of an elastic body (MammogramBody) whose border moves as drawn; MLO views have a muscle
  /// ten times as stiff, across whose edge the strain jumps. Else all tissue moves as drawn, which is smooth.
  bool elastic = false;
  /// A further part of the true map (MammogramDeformation), unless that is elastic; null: none.
  std::shared_ptr<const Transform<2>> further = nullptr;
};

/// One of the two images and what is known about it. Points are in mm.
struct MammogramImage {
  Image<float, 2> pixels;  ///< whole grey levels, 0 to 2^bits - 1
  Mask<2> mask;            ///< 1 where a pixel's centre is in the breast
  LabelImage<2>
      labels;         ///< 1 where it is in the pectoral muscle, within the breast; CC views: empty
  Polyline outline;   ///< skin line from the upper to the lower end, as far as the frame shows it
  Polyline pectoral;  ///< edge of the pectoral muscle from the chest wall to the skin; CC: empty
  Point<2> nipple = Point<2>::Zero();
  std::vector<DuctMark> marks;  ///< forks and crossings of ducts, their positions in mm
};

/// Two mammograms and the map between them, known exactly.
///
/// A breast is described by formulas in the fixed image's space (MammogramTissue) and moved by a known map T
/// (MammogramDeformation). The fixed image shows the breast at x, the moving image at T^-1(y), found for each
/// of its pixels: nothing is interpolated from a finished image. Then both are blurred, the moving image's
/// response is changed a little, noise is added, and both are digitised. Film and label do not move.
///
/// Bilateral pairs: the moving image is mirrored left to right, and so is T; the other breast has the same
/// outline, other textures and 60 % of the ducts.
struct MammogramPhantom {
  MammogramImage fixed, moving;
  std::function<Point<2>(const Point<2>&)> truth;    ///< T, fixed to moving, mm
  std::function<Point<2>(const Point<2>&)> inverse;  ///< T^-1, to 1e-10 of a pixel
  DisplacementField<2> displacement;                 ///< T(x) - x on the fixed raster, mm
  /// Pairs that both frames show: 40 at equal arc lengths of the skin line ("contour 1", ...), the nipple,
  /// and the forks that both breasts have, with the directions of the ducts that lead to them.
  Landmarks<2> landmarks;
  /// All that was chosen, by name.
  std::vector<std::pair<std::string, double>> parameters;
};

/// Makes a phantom. The same options give the same bytes on any number of threads. Where the drawn motion
/// squeezes tissue to a determinant of 0.4 or less anywhere in the frame, or leaves an elastic body without an
/// equilibrium, all of it is halved until it does not, ten times at most.
/// @throws InvalidInput for an option out of range, naming the range, for a further map of an elastic body, or
/// when the further map alone squeezes tissue that much.
MammogramPhantom make_mammogram_phantom(const MammogramPhantomOptions& options = {});

}  // namespace crease
