#pragma once

#include <array>
#include <vector>

#include "Transforms/Domains/KnotNet.h"

namespace crease {

/// As KnotOptions, for tetrahedra.
struct VolumeKnotOptions {
  int degree = 2;
  int smoothness = -1;  ///< as in KnotOptions
  double alpha = 0.5;   ///< cloud radius over the smallest insphere radius at the vertex, in (0, 1)
};

/// Knots for a tetrahedral mesh without creases: generic clouds inside; on the border in the intersection of the outer half-spaces
/// of the faces there, or all at the vertex where that has no interior (saddles).
/// @throws InvalidInput for options out of range or folded tetrahedra.
KnotNet<3> place_knots(const SimplexMesh<3>& mesh, const VolumeKnotOptions& options = {});

/// A face that belongs to one tetrahedron.
struct BorderFace {
  std::array<int, 3> vertices{};
  Vector<3> outwards = Vector<3>::Zero();  ///< unit normal
};
std::vector<BorderFace> border_faces(const SimplexMesh<3>& mesh);

/// Checks that tetrahedron t is positive, and its knots fulfil the conditions for a basis; see validate().
void check_tetrahedron(const KnotNet<3>& net, std::size_t t);
/// Checks that knots of border vertices are outside the planes of their border faces.
void check_border_faces(const KnotNet<3>& net);

}  // namespace crease
