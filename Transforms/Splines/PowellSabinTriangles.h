#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "Transforms/Domains/KnotNet.h"

namespace crease {

/// Three corners, counter-clockwise, mm.
using PowellSabinTriangle = std::array<Point<2>, 3>;

/// The local functions of a vertex V: barycentric coordinates in the triangle of their control points; on a
/// crease, where the gradient may jump, in a tetrahedron above the plane.
///
/// There a point p is lifted to (x, y, depth), depth = normal . (p - V) on the far side of the crease and 0 on
/// the near side and on the crease's edges. Functions linear in (x, y, depth) are linear on either side and
/// agree on the tangent.
struct PowellSabinVertex {
  /// One column per function: x, y of its control point and depth, mm. Three of depth 0, or four.
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 4> corners;
  /// Unit normal of the crease's tangent, towards the far side; 0: no crease.
  Vector<2> normal = Vector<2>::Zero();

  int num_functions() const { return static_cast<int>(corners.cols()); }
  bool creased() const { return corners.cols() == 4; }
};

/// A mesh whose vertices carry one triangle (or tetrahedron) each: all that a Powell-Sabin basis is built from.
struct PowellSabinNet {
  SimplexMesh<2> mesh;
  std::vector<PowellSabinVertex> vertices;
  /// Edges inside the domain across which the gradient may jump, if their vertices let it. `body_side`: a
  /// body lies on the near side, and what bends at the crease lies wholly on the far one.
  std::vector<CreaseEdge> crease_edges;
};

/// A triangle of nearly the least area that holds a convex polygon (counter-clockwise, three corners or
/// more): the smallest of all that have two sides along edges of the polygon and the third either along an edge
/// too or touching a corner with its midpoint. (The smallest of all triangles has its sides' midpoints
/// on the polygon; leaving out those with one side along an edge costs little and keeps this to
/// O(n^3).) The same polygon always gives the same triangle. It may lack a part of the polygon as wide as rounding.
/// @throws InvalidInput when the polygon has no area.
PowellSabinTriangle enclosing_triangle(std::span<const Point<2>> polygon);

/// The vertex' functions by that triangle.
PowellSabinVertex triangle_vertex(const PowellSabinTriangle& triangle);

/// Gives every vertex a small triangle that holds the points of PowellSabinSides: the smaller it is, the closer
/// control points lie to the surface.
///
/// Source: P. Dierckx, "On calculating normalized Powell-Sabin B-splines", Computer Aided Geometric Design 15,
/// 1997, who asks for the least area and finds it by quadratic programming.
/// @throws InvalidInput for what PowellSabinSplit refuses.
PowellSabinNet place_powell_sabin(SimplexMesh<2> mesh);

}  // namespace crease
