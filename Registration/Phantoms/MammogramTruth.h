#pragma once

#include "Core/Box.h"
#include "Registration/Phantoms/MammogramDeformation.h"
#include "Registration/Phantoms/MammogramPhantom.h"

// What the mammogram phantom knows about its images.
namespace crease {

/// The true map of a pair: a deformation, mirrored left to right for bilateral pairs.
struct MammogramMap {
  MammogramDeformation deformation;
  bool mirrored = false;
  double right_mm = 0;  ///< x of the last column

  Point<2> mirror(const Point<2>& y) const {
    return mirrored ? Point<2>(right_mm - y.x(), y.y()) : y;
  }
  Point<2> operator()(const Point<2>& x) const { return mirror(deformation(x)); }
  Point<2> inverse(const Point<2>& y) const {
    const Point<2> start = mirror(y);
    return deformation.inverse(start, start);
  }
  /// Direction of T's image of a line through x, radians.
  double carried_angle(const Point<2>& x, double angle_rad) const;
};

/// Outline, pectoral line, nipple and marks of the fixed image.
void describe_fixed(const std::vector<Duct>& ducts, MammogramView view, MammogramImage& image);
/// Those of the moving image, as far as its frame shows them.
/// @param ducts  of its breast, in the fixed image's space.
void describe_moving(const std::vector<Duct>& ducts, MammogramView view, const MammogramMap& map,
                     MammogramImage& image);

/// MammogramPhantom::landmarks.
Landmarks<2> mammogram_landmarks(const MammogramImage& fixed, const MammogramImage& moving,
                                 const MammogramMap& map);

/// By name, for MammogramPhantom::parameters.
std::vector<std::pair<std::string, double>> motion_parameters(const MammogramMotion& motion);

}  // namespace crease
