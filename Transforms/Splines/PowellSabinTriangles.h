#pragma once

#include <array>
#include <span>
#include <vector>

#include "Transforms/Splines/PowellSabinSplit.h"

namespace crease {

/// Three corners, counter-clockwise, mm.
using PowellSabinTriangle = std::array<Point<2>, 3>;

/// A mesh whose vertices carry one triangle each: all that a Powell-Sabin basis is built from.
struct PowellSabinNet {
  SimplexMesh<2> mesh;
  std::vector<PowellSabinTriangle> triangles;  ///< of the vertices
};

/// The points that the triangle of a vertex must hold for the vertex' functions not to be negative: the
/// vertex V, (V + R) / 2 for the points R of its edges, (V + Z) / 2 for the centres Z of its triangles.
std::vector<Point<2>> powell_sabin_points(const SimplexMesh<2>& mesh, const PowellSabinSplit& split,
                                          int vertex);

/// A triangle of nearly the least area that holds a convex polygon (counter-clockwise, three corners or
/// more): the smallest of all that have two sides along edges of the polygon and the third either along an edge
/// too or touching a corner with its midpoint. (The smallest of all triangles has its sides' midpoints
/// on the polygon; leaving out those with one side along an edge costs little and keeps this to
/// O(n^3).) The same polygon always gives the same triangle. It may lack a part of the polygon as wide as rounding.
/// @throws InvalidInput when the polygon has no area.
PowellSabinTriangle enclosing_triangle(std::span<const Point<2>> polygon);

/// Gives every vertex a small triangle round its points: the smaller they are, the closer control points lie
/// to the surface.
///
/// Source: P. Dierckx, "On calculating normalized Powell-Sabin B-splines", Computer Aided Geometric Design 15,
/// 1997, who asks for the least area and finds it by quadratic programming.
/// @throws InvalidInput for what PowellSabinSplit refuses.
PowellSabinNet place_powell_sabin(SimplexMesh<2> mesh);

}  // namespace crease
