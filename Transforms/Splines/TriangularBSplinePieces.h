#pragma once

#include <vector>

#include "Transforms/Splines/DeterminantPieces.h"
#include "Transforms/Splines/KnotCells.h"
#include "Transforms/Splines/TriangularBSplineEvaluator.h"

namespace crease {

/// det grad T of a triangular B-spline map on the cells of its knot segments, fanned into triangles: a
/// polynomial of degree 2 (n - 1).
///
/// The rough bound comes from the derivative, itself a triangular B-spline of degree n - 1 on the first n
/// knots of each cloud:
///
///     grad u = sum_{I, |gamma| = n-1} G_{I,gamma} N_gamma^I,   G_{I,gamma} = n sum_j phi_{gamma+e_j} grad lambda_j(. | X_gamma^I),
///
/// (the terms along edges cancel between neighbours, whose control points are shared). Its functions are not
/// negative and sum to 1, so grad T lies in the hull of linear + G, and det, a quadratic form, is not below
/// the least polar form D(M_k, M_l) = (det(M_k + M_l) - det M_k - det M_l) / 2 of a pair of them.
/// Source: Dahmen, Micchelli, Seidel, "Blossoming Begets B-Spline Bases Built Better by B-Patches",
/// Math. Comp. 59, 1992.
class TriangularBSplinePieces final : public DeterminantPieces<2> {
 public:
  /// All arguments must outlive this.
  TriangularBSplinePieces(const KnotNet<2>& net, const KnotControlPoints<2>& control_points,
                          const TriangularBSplineEvaluator& evaluator, const KnotCells& cells,
                          const ControlPoints<2>& phi, const Matrix<2>& linear);

  int num_patches() const override { return static_cast<int>(net_.mesh.simplices.size()); }
  double rough_bound(int patch) const override;
  std::vector<DeterminantPiece<2>> pieces(int patch) const override;

  /// Matrices in whose hull grad T lies everywhere in a triangle.
  std::vector<Matrix<2>> gradient_hull(int triangle) const;

 private:
  struct Nodes;
  void set_gradients(int triangle);
  void evaluate(int triangle, Nodes& nodes) const;

  const KnotNet<2>& net_;
  const KnotControlPoints<2>& control_points_;
  const TriangularBSplineEvaluator& evaluator_;
  const KnotCells& cells_;
  const ControlPoints<2>& phi_;
  Matrix<2> linear_;
  double tie_;
  std::vector<MultiIndex<2>> gammas_;
  std::vector<std::vector<int>> neighbours_;
  std::vector<Matrix<2>> gradients_;  // linear + G by triangle, then gamma
  std::vector<double> errors_;        // of a triangle's; infinite where its knots give no hull
};

}  // namespace crease
