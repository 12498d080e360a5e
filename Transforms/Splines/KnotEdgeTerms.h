#pragma once

#include <span>
#include <vector>

#include "Core/Point.h"
#include "Transforms/Splines/TriangularBSplineKernels.h"

namespace crease {

/// The simplex splines E(p, q) = M(. | a_0..a_p, b_0..b_q), 1 <= p + q <= n, of the two clouds of an
/// edge with their recurrences (split set: largest |det|). They live in the strip conv(A u B) along the
/// edge and are what distinguishes a triangular B-spline from one polynomial per triangle.
struct KnotEdgeTerms {
  /// Clouds of the edge's ends, degree + 1 knots each.
  KnotEdgeTerms(std::span<const Point<2>> a, std::span<const Point<2>> b, int degree);

  Point<2> origin;                             ///< a_0; the nodes' coordinates are relative to it
  std::vector<std::array<Point<2>, 2>> pairs;  ///< of knots whose lines the leaves need
  std::vector<LaneLeaf> leaves;  ///< lines number the pairs; sign +1: left of pair[0] -> pair[1]
  std::vector<LaneNode> nodes;
  std::vector<int> slots;
};

}  // namespace crease
