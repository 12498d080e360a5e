#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "Transforms/Domains/Polygon.h"

// The milk ducts of the mammogram phantom: four trees that fork three times, in the coordinates of
// MammogramOutline.h.
namespace crease {

/// A piece of a duct from one fork to the next: an arc of a circle.
struct Duct {
  int number = 0;   ///< 1 to 60; 60 more for those that the other breast alone has
  int parent = -1;  ///< position in the list of ducts; -1: starts behind the nipple
  Point<2> start = Point<2>::Zero();
  double angle_rad = 0;  ///< of the direction at the start
  double turn_rad = 0;   ///< from the direction at the start to that at the end
  double length = 0;
  double width = 0;

  /// The point at a share of the length, 0 to 1.
  Point<2> point(double share) const;
  double angle_at(double share) const { return angle_rad + share * turn_rad; }
  /// Distance from x to the arc.
  double distance(const Point<2>& x) const;
};

/// 60 ducts. Four start 0.03 behind the nipple at angles pi + {-0.55, -0.2, 0.15, 0.5}, are 0.11 long and
/// 4.2/1024 wide, and fork three times:
///
///     turn       N(0, 0.25)
///     branches   half-angle U(0.45, 0.75), times U(0.7, 1.1) for each of the two
///     length     times U(0.7, 0.95) for each, width times 0.85
///
/// @param other_breast  the ducts of the woman's other breast: 36 of the 60 are the same, namely the four
///   trunks, the eight ducts that they fork into, and what grows from four of these.
std::vector<Duct> draw_ducts(std::uint64_t seed, bool other_breast = false);

/// Where ducts fork or cross in the image.
struct DuctMark {
  std::string name;  ///< "branch 7": end of duct 7; "crossing 7-23"
  bool crossing = false;
  Point<2> position = Point<2>::Zero();
  /// Branches: direction from the fork back along the duct that comes from the nipple, then those of the two
  /// it forks into. Crossings: directions of the two ducts. Radians, -pi to pi.
  std::vector<double> angles_rad;
};

/// All forks and crossings inside the breast, forks first.
std::vector<DuctMark> duct_marks(const std::vector<Duct>& ducts);

/// How much of a point is covered by ducts when these are drawn as strips blurred by a Gaussian: 0 to 1.
/// Looks at the ducts near the point only.
class DuctDrawing {
 public:
  /// @param blur  deviation of the Gaussian, > 0.
  DuctDrawing(std::vector<Duct> ducts, double blur);

  double coverage(const Point<2>& x) const;

 private:
  static int bin(const Point<2>& x);  // -1: outside all bins

  std::vector<Duct> ducts_;
  double blur_;
  std::vector<std::vector<int>> ducts_of_bin_;
};

}  // namespace crease
