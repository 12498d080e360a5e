#pragma once

#include <vector>

#include "Core/Point.h"

namespace crease {

/// Polygons in space that share vertices.
struct SurfaceMesh {
  std::vector<Point<3>> vertices;       ///< mm
  std::vector<std::vector<int>> faces;  ///< vertex numbers from 0 in order, at least three each
};

/// Counts that tell a mesh's shape apart.
struct SurfaceTopology {
  int edges = 0;
  int components = 0;          ///< parts that share no vertex; vertices without a face do not count
  int boundary_loops = 0;      ///< closed rings of edges that have one face
  int non_manifold_edges = 0;  ///< with three faces or more
  int euler = 0;               ///< vertices with a face - edges + faces
  /// Handles of all components together; -1 where that has no meaning: on non-manifold edges or one-sided
  /// surfaces.
  int genus = -1;
};

SurfaceTopology surface_topology(const SurfaceMesh& mesh);

}  // namespace crease
