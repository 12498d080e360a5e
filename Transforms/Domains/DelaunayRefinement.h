#pragma once

#include <array>
#include <functional>
#include <vector>

#include "Core/Point.h"
#include "Transforms/Domains/SimplexMesh.h"

namespace crease {

/// A planar graph to be triangulated. Its border edges enclose the domain.
struct DelaunayInput {
  std::vector<Point<2>> vertices;
  std::vector<std::array<int, 2>> edges;                ///< meet in vertices only; border and lines
  std::vector<Point<2>> holes;                          ///< a point in each hole
  std::vector<Point<2>> inner_points;                   ///< wished for, not bound to any edge
  std::function<double(const Point<2>&)> largest_edge;  ///< mm, at a triangle's centroid
  double shape_bound = 0.125;                           ///< squared sine of the smallest angle
  int most_vertices = 1'100'000;
};

struct DelaunayOutput {
  SimplexMesh<2> mesh;  ///< input vertices that are used come first, in their order
  std::vector<std::vector<int>> edge_paths;  ///< per input edge its mesh vertices, ends included
  bool too_many = false;  ///< stopped because of most_vertices; mesh and paths are empty
};

/// Constrained Delaunay triangulation, refined until every triangle is small and round enough, edges
/// divided where needed. The same input gives the same output.
///
/// Source: J. Shewchuk, "Delaunay refinement algorithms for triangular mesh generation", Comp. Geometry 22,
/// 2002, as implemented by CGAL's Delaunay_mesher_2.
/// @throws InvalidInput when edges cross.
DelaunayOutput refine_delaunay(const DelaunayInput& input);

}  // namespace crease
