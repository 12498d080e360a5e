#pragma once

#include <array>
#include <vector>

#include "Transforms/Domains/SimplexMesh.h"

namespace crease {

/// The facets (edges in 2D, triangles in 3D) that belong to one simplex only, as vertex numbers.
/// @throws InvalidInput when a facet belongs to more than two.
template <int Dim>
std::vector<std::array<int, Dim>> border_facets(const SimplexMesh<Dim>& mesh);

}  // namespace crease
