#pragma once

#include <vector>

#include "Transforms/Domains/DomainMesh.h"
#include "Transforms/Domains/FeatureLine.h"
#include "Transforms/Domains/RegionOfInterest.h"

namespace crease {

/// A disc in which edges are to be no longer than this; beyond it they grow as away from lines.
struct FineDisc {
  Point<2> centre = Point<2>::Zero();
  double radius = 0;       ///< mm
  double edge_length = 0;  ///< mm, mean
};

/// Edge lengths are mean lengths wanted, mm; 0 asks for the default.
struct MeshOptions {
  double edge_length = 0;             ///< away from lines; default a twelfth of the longer side
  double edge_length_near_lines = 0;  ///< along feature lines; default half of edge_length
  double edge_length_in_bodies =
      0;                   ///< inside bodies, away from their outline; default edge_length
  double gradation = 0.4;  ///< growth of the edge length per mm of distance to a line
  std::vector<FineDisc> fine_discs;  ///< finer than the other lengths ask for
  int num_triangles = 0;  ///< > 0: all lengths but those of discs are scaled until it is within 5 %
  double line_tolerance = 0;   ///< mm that sampled lines may run off; default 1/20 of their edges
  bool resample_lines = true;  ///< false: lines keep their points unless nearer than a quarter edge
};

inline constexpr int kMostTriangles = 2'000'000;

/// Triangulates a region of interest so that the feature lines run along edges: constrained Delaunay, smallest angle
/// 20.7 degrees where the input's own angles allow it, edges growing from the lines into the open.
///
/// Lines are clipped to the region, sampled to about `edge_length_near_lines` (corners stay), merged where
/// they come nearer to each other than a quarter edge, and get vertices where they cross. The triangles inside
/// closed lines with a body, or inside the outlines of a label image, carry its label as region. The result
/// does not depend on the order and direction of the lines.
///
/// Cost: about 4 microseconds per triangle.
///
/// @throws InvalidInput for lines that are no creases, lie outside, or lengths that ask for more than two million
///         triangles.
DomainMesh mesh_domain(const RegionOfInterest& region, const std::vector<FeatureLine>& lines,
                       const MeshOptions& options = {});

}  // namespace crease
