#pragma once

#include <array>
#include <span>
#include <vector>

#include "Core/Box.h"
#include "Transforms/Domains/KnotNet.h"

namespace crease {

/// Finds the simplex of a mesh that holds a point: a uniform grid of cells, each with the simplices
/// whose boxes meet it.
template <int Dim>
class KnotLocator {
 public:
  /// @param tie  distance in mm within which a point counts as in a closed simplex.
  KnotLocator(const SimplexMesh<Dim>& mesh, double tie);

  /// The simplex with the lowest number that holds u, -1 outside the mesh.
  int find(const Point<Dim>& u) const;
  const Box<Dim>& bounds() const { return box_; }

 private:
  struct Facets {  // of one simplex: lambda_j = normal_j . u - offset_j, in mm
    Eigen::Matrix<double, Dim, Dim + 1> normals;
    Eigen::Matrix<double, Dim + 1, 1> offsets;
  };
  std::array<int, Dim> cell(const Point<Dim>& u) const;
  int cell_number(const std::array<int, Dim>& cell) const;
  template <typename Visitor>
  void for_cells_of(const Box<Dim>& box, const Visitor& visit) const;

  Box<Dim> box_;
  std::array<int, Dim> size_{};
  Vector<Dim> cells_per_mm_;
  double tie_;
  std::vector<Facets> facets_;
  std::vector<int> cell_start_;  // into simplices_
  std::vector<int> simplices_;
};

/// For every simplex those that share a vertex with it, itself included, ascending.
template <int Dim>
std::vector<std::vector<int>> vertex_neighbours(const SimplexMesh<Dim>& mesh);

/// The corners of a simplex, mm.
template <int Dim>
std::array<Point<Dim>, Dim + 1> simplex_corners(const SimplexMesh<Dim>& mesh, int simplex) {
  std::array<Point<Dim>, Dim + 1> corners;
  for (int j = 0; j <= Dim; ++j) corners[j] = mesh.vertices[mesh.simplices[simplex][j]];
  return corners;
}

/// The clouds of a simplex's corners, as BPatch wants them. The net must outlive the spans.
template <int Dim>
std::array<std::span<const Point<Dim>>, Dim + 1> simplex_clouds(const KnotNet<Dim>& net,
                                                                int simplex) {
  std::array<std::span<const Point<Dim>>, Dim + 1> clouds;
  for (int j = 0; j <= Dim; ++j) clouds[j] = net.clouds[net.mesh.simplices[simplex][j]];
  return clouds;
}

template <int Dim>
Point<Dim> simplex_centroid(const SimplexMesh<Dim>& mesh, int simplex) {
  Point<Dim> sum = Point<Dim>::Zero();
  for (const Point<Dim>& corner : simplex_corners(mesh, simplex)) sum += corner;
  return sum / (Dim + 1);
}

/// Length that tolerances refer to: the diagonal of the mesh's box, mm.
template <int Dim>
double mesh_scale(const SimplexMesh<Dim>& mesh) {
  return bounding_box<Dim>(mesh.vertices).diagonal();
}

/// Distance from a knot line, relative to mesh_scale(), that counts as on it.
inline constexpr double kKnotTie = 1e-11;

extern template class KnotLocator<2>;
extern template class KnotLocator<3>;

}  // namespace crease
