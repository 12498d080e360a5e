#pragma once

#include <vector>

#include "Transforms/Domains/CreaseBands.h"
#include "Transforms/Splines/KnotPolygon.h"

namespace crease {

/// A convex cell of the arrangement of knot segments within one triangle: every basis function is one
/// polynomial there.
struct KnotCell {
  KnotPolygon polygon;
  Point<2> centroid = Point<2>::Zero();
  double area = 0.0;               ///< mm^2
  bool in_band = false;            ///< in the band of any crease edge
  bool in_two_sided_band = false;  ///< in the band of a crease edge without a body side
};

/// Cuts the triangles of a net along the segments between knots that occur together in a function:
/// t_{a,i} t_{b,j} with i + j <= n across an edge, and all pairs within a cloud; and along the sides of the
/// bands of crease edges, so that a cell is inside or outside them as a whole (CreaseBands).
class KnotCells {
 public:
  /// The net must outlive this and be valid (validate).
  explicit KnotCells(const KnotNet<2>& net);

  /// The cells of a triangle; their areas sum to its own.
  std::vector<KnotCell> of_triangle(int triangle) const;
  /// Whether a crease's band reaches into the triangle.
  bool meets_band(int triangle) const { return !bands_.bands_in(triangle).empty(); }

 private:
  struct Segment {
    Point<2> start;
    Vector<2> direction;  // unit
    double length = 0.0;
  };
  void add_segment(const Point<2>& a, const Point<2>& b, const KnotPolygon& triangle,
                   std::vector<Segment>& segments) const;
  std::vector<Segment> segments_in(int triangle, const KnotPolygon& corners) const;
  void cut(std::vector<KnotPolygon>& polygons, const Segment& segment) const;

  const KnotNet<2>& net_;
  double tie_;
  std::vector<std::vector<int>> neighbours_;
  CreaseBands bands_;
};

}  // namespace crease
