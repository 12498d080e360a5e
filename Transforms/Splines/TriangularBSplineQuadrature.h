#pragma once

#include <vector>

#include "Transforms/Splines/KnotCells.h"
#include "Transforms/Splines/KnotCongruence.h"
#include "Transforms/Splines/SplineBasis.h"
#include "Transforms/Splines/TriangularBSplineEvaluator.h"

namespace crease {

/// The elements of some triangles, in their order: their cells with Gauss rules and the functions at the
/// points, each cell's polynomials evaluated with the sides of knot lines that hold at its centroid.
/// Congruent triangles are computed once and moved. Parallel over triangles.
class TriangularBSplineQuadrature {
 public:
  /// All arguments must outlive this.
  TriangularBSplineQuadrature(const KnotNet<2>& net, const KnotControlPoints<2>& control_points,
                              const TriangularBSplineEvaluator& evaluator);

  std::vector<QuadratureElement<2>> elements(std::span<const int> triangles, int polynomial_degree,
                                             int derivatives) const;

  const KnotCells& cells() const { return cells_; }
  const KnotCongruence& congruence() const { return congruence_; }

 private:
  using Elements = std::vector<QuadratureElement<2>>;
  Elements of_triangle(int triangle, int polynomial_degree, int derivatives) const;
  bool movable(int triangle) const;
  bool move(const Elements& from, int triangle, Elements& elements) const;

  const KnotNet<2>& net_;
  const KnotControlPoints<2>& control_points_;
  const TriangularBSplineEvaluator& evaluator_;
  KnotCells cells_;
  KnotCongruence congruence_;
};

/// Pairs i <= k of control points whose functions' supports (hulls of knots) overlap.
std::vector<std::pair<int, int>> overlapping_functions(const KnotNet<2>& net,
                                                       const KnotControlPoints<2>& control_points);

}  // namespace crease
