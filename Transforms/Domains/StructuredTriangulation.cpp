#include "Transforms/Domains/StructuredTriangulation.h"

#include <algorithm>

#include "Core/Error.h"

namespace crease {
namespace {

template <int Dim>
void check(const Box<Dim>& box, const std::array<int, Dim>& cells) {
  if (!(box.size().array() > 0).all() || !box.size().allFinite()) {
    throw InvalidInput("structured triangulation: the box is empty or flat.");
  }
  for (int count : cells) {
    if (count < 1) {
      throw InvalidInput(message("structured triangulation: ", count,
                                 " cells along an axis; at least one is needed."));
    }
  }
}

}  // namespace

SimplexMesh<2> structured_triangulation(const Box<2>& box, int columns, int rows,
                                        Diagonals diagonals) {
  check<2>(box, {columns, rows});
  SimplexMesh<2> mesh;
  const auto number = [&](int i, int j) { return j * (columns + 1) + i; };
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      mesh.vertices.emplace_back(box.lower.x() + box.size().x() * i / columns,
                                 box.lower.y() + box.size().y() * j / rows);
    }
  }
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const int a = number(i, j), b = number(i + 1, j);
      const int c = number(i + 1, j + 1), d = number(i, j + 1);
      const bool rising = diagonals == Diagonals::kRising ||
                          (diagonals == Diagonals::kUnionJack && (i + j) % 2 == 0);
      if (rising) {
        mesh.simplices.push_back({a, b, c});
        mesh.simplices.push_back({a, c, d});
      } else {
        mesh.simplices.push_back({a, b, d});
        mesh.simplices.push_back({b, c, d});
      }
    }
  }
  mesh.regions.assign(mesh.simplices.size(), 0);
  return mesh;
}

SimplexMesh<3> structured_tetrahedra(const Box<3>& box, const std::array<int, 3>& cells) {
  check<3>(box, cells);
  SimplexMesh<3> mesh;
  const auto number = [&](const std::array<int, 3>& i) {
    return (i[2] * (cells[1] + 1) + i[1]) * (cells[0] + 1) + i[0];
  };
  for (int k = 0; k <= cells[2]; ++k) {
    for (int j = 0; j <= cells[1]; ++j) {
      for (int i = 0; i <= cells[0]; ++i) {
        const Vector<3> part(static_cast<double>(i) / cells[0], static_cast<double>(j) / cells[1],
                             static_cast<double>(k) / cells[2]);
        mesh.vertices.push_back(box.lower + box.size().cwiseProduct(part));
      }
    }
  }
  for (int k = 0; k < cells[2]; ++k) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int i = 0; i < cells[0]; ++i) {
        // A tetrahedron for each order in which the three axes are walked from corner to corner.
        std::array<int, 3> axes = {0, 1, 2};
        do {
          std::array<int, 3> corner = {i, j, k};
          std::array<int, 4> tetrahedron{number(corner)};
          for (int step = 0; step < 3; ++step) {
            ++corner[axes[step]];
            tetrahedron[step + 1] = number(corner);
          }
          const bool even = axes == std::array{0, 1, 2} || axes == std::array{1, 2, 0} ||
                            axes == std::array{2, 0, 1};
          if (!even) std::swap(tetrahedron[2], tetrahedron[3]);
          mesh.simplices.push_back(tetrahedron);
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
    }
  }
  mesh.regions.assign(mesh.simplices.size(), 0);
  return mesh;
}

}  // namespace crease
