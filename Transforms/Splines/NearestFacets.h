#pragma once

#include <array>
#include <vector>

#include "Core/Box.h"
#include "Transforms/Domains/SimplexMesh.h"

namespace crease {

/// Finds the point of a mesh's facets that is nearest to a point: a tree of boxes, each with the facets
/// that may be the nearest for one of its points. Linear search where it ends and far away.
template <int Dim>
class NearestFacets {
 public:
  using Facet = std::array<int, Dim>;
  struct Found {
    int facet = -1;  ///< of those given, the first if several are as near
    Point<Dim> point;
  };

  NearestFacets() = default;
  /// @param facets  vertices of the mesh: two of an edge, three of a triangle.
  NearestFacets(const SimplexMesh<Dim>& mesh, const std::vector<Facet>& facets);

  /// @throws InvalidInput without facets.
  Found find(const Point<Dim>& x) const;
  const std::array<Point<Dim>, Dim>& corners(int facet) const { return corners_[facet]; }
  int num_facets() const { return static_cast<int>(corners_.size()); }

 private:
  struct Node {
    int first_child = -1;  // of 2^Dim in a row; -1: a leaf
    std::vector<int> facets;
  };
  void split(int node, const Box<Dim>& box, int depth);

  std::vector<std::array<Point<Dim>, Dim>> corners_;
  Box<Dim> box_;
  std::vector<Node> nodes_;
};

extern template class NearestFacets<2>;
extern template class NearestFacets<3>;

}  // namespace crease
