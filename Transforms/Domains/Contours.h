#pragma once

#include <functional>
#include <vector>

#include "Transforms/Domains/Polygon.h"

namespace crease {

/// A stretch of border between two labels of a grid.
struct ContourArc {
  Polyline points;  ///< in steps of the grid, node (i, j) at (i, j)
  bool closed = false;
  int left = 0, right = 0;  ///< labels on either side, walking along the points in the (i, j) frame
};

/// The borders between labels of a width x height grid (i fastest), by marching squares with any number of
/// labels: closed arcs, and arcs that end at the grid's rim or where three labels meet. Arcs meet in equal points.
///
/// @param share  share(label, node) grows with the label's claim on the node, whose own label has the largest;
///               the border between nodes p of label a and q of label b lies where the two claims are equal,
///               interpolated along the grid's edge.
/// Source: Lorensen and Cline, "Marching cubes", SIGGRAPH 1987, in its planar form.
std::vector<ContourArc> trace_contours(int width, int height, const std::vector<int>& labels,
                                       const std::function<double(int label, int node)>& share);

}  // namespace crease
