#pragma once

#include <array>
#include <span>
#include <vector>

#include "Core/Point.h"

namespace crease {

/// The line (2D) or plane (3D) { u : normal . u = offset } through knots; the normal has unit length.
template <int Dim>
struct KnotPlane {
  Vector<Dim> normal;
  double offset = 0.0;

  /// Signed distance, mm.
  double distance(const Point<Dim>& u) const { return normal.dot(u) - offset; }
};

/// Lines through pairs of knots (planes through triples), each once.
template <int Dim>
struct KnotPlanes {
  std::vector<KnotPlane<Dim>> planes;
  std::vector<int> plane_of_facet;  ///< parallel to the facets given
};

/// Facets whose knots lie on one plane (along creases, straight borders) share one entry, so that all
/// functions decide alike on which side of it a point lies.
/// @param facets  Dim knots each, affinely independent.
/// @param tie     distance in mm within which knots count as on a plane.
template <int Dim>
KnotPlanes<Dim> merge_planes(std::span<const std::array<Point<Dim>, Dim>> facets, double tie);

}  // namespace crease
