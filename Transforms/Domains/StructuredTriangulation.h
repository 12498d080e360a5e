#pragma once

#include <array>

#include "Core/Box.h"
#include "Transforms/Domains/SimplexMesh.h"

namespace crease {

/// How the cells of a grid are cut: diagonals through the vertices with even i + j (union jack), all from
/// lower left to upper right, or all from upper left to lower right.
enum class Diagonals { kUnionJack, kRising, kFalling };

/// Rows x columns cells of a rectangle, two triangles each: (columns + 1)(rows + 1) vertices, vertex (i, j) at
/// number j (columns + 1) + i.
/// @throws InvalidInput when a count is below 1 or the box has no area.
SimplexMesh<2> structured_triangulation(const Box<2>& box, int columns, int rows,
                                        Diagonals diagonals = Diagonals::kUnionJack);

/// Cubes of a box, each cut into six tetrahedra round its main diagonal (Kuhn): conforming.
/// @throws InvalidInput when a count is below 1 or the box has no volume.
SimplexMesh<3> structured_tetrahedra(const Box<3>& box, const std::array<int, 3>& cells);

}  // namespace crease
