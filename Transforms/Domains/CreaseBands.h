#pragma once

#include <array>
#include <vector>

#include "Transforms/Domains/KnotNet.h"
#include "Transforms/Domains/Polygon.h"

namespace crease {

/// The narrow bands in which a creased spline turns: per crease edge the convex hull of both clouds.
///
/// Most sides of a band are segments between knots of one function, and cells of the knot arrangement are cut
/// along the others too: a cell is inside or outside as a whole, and its centroid decides. Bending energy skips
/// the bands; so does rigidity those without a body side.
class CreaseBands {
 public:
  /// Where one crease edge turns.
  struct Band {
    std::array<int, 2> vertices{};
    bool body_side = false;
    Polyline hull;  ///< counter-clockwise; fewer than three points: the band is empty
  };

  CreaseBands() = default;
  explicit CreaseBands(const KnotNet<2>& net);

  const std::vector<Band>& bands() const { return bands_; }
  /// Whether a point of a triangle lies in a band.
  bool contains(int triangle, const Point<2>& p) const;
  /// The same for the bands without a body side.
  bool contains_two_sided(int triangle, const Point<2>& p) const;
  /// Numbers of the bands that reach into a triangle.
  const std::vector<int>& bands_in(int triangle) const { return in_triangle_[triangle]; }
  /// Area of all bands together inside a triangle, mm^2, overlaps counted once; with `only_body_side` of those
  /// with a body side.
  double area_in(int triangle, bool only_body_side = false) const;

 private:
  std::vector<Band> bands_;
  std::vector<std::vector<int>> in_triangle_;
  std::vector<std::array<Point<2>, 3>> corners_;
};

}  // namespace crease
