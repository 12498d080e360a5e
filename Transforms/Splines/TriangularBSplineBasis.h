#pragma once

#include <memory>
#include <vector>

#include "Transforms/Domains/KnotNet.h"
#include "Transforms/Splines/BPatch.h"
#include "Transforms/Splines/KnotControlPoints.h"
#include "Transforms/Splines/NearestFacets.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

template <int Dim>
class KnotLocator;
template <int Dim>
class SimplexSplineGraph;
class TriangularBSplineEvaluator;
class TriangularBSplineQuadrature;

/// Triangular B-splines (DMS-splines) of degree 1 to 5 on a triangulation whose vertices carry clouds of
/// knots; in 3D tetrahedral ones.
///
///     F(u) = sum_I sum_{|beta| = n} c_{I,beta} N_beta^I(u),   N_beta^I = |det X_beta^I| M(u | V_beta^I),
///
/// with control points shared between neighbours (KnotControlPoints). The functions are not negative,
/// sum to 1, contain all polynomials of degree n, and are C^{n-1} wherever knots are in general
/// position; knots on one line make a crease of it. In the core of a triangle the spline is one
/// polynomial (BPatch), in the strips between cores it is evaluated by the knots' recurrence.
///
/// In 3D, quadrature() and bind() throw InvalidInput.
/// Source: Dahmen, Micchelli, Seidel, "Blossoming Begets B-Spline Bases Built Better by B-Patches",
/// Math. Comp. 59, 1992; dissertation, chapters 2 and 3.
template <int Dim>
class TriangularBSplineBasis final : public SplineBasis<Dim> {
 public:
  /// @throws InvalidInput for a degree outside 1..5, numbers that are not finite, clouds of the wrong
  /// size, folded or isolated parts of the mesh, clouds too large for their triangles, border clouds
  /// that reach into the domain; the message names the vertex or simplex.
  explicit TriangularBSplineBasis(KnotNet<Dim> net);
  ~TriangularBSplineBasis() override;

  const KnotNet<Dim>& net() const { return net_; }
  /// Control points of a simplex's local functions, by multi_index_position.
  std::span<const int> control_points_of(int simplex) const {
    return control_points_.of_simplex(simplex);
  }
  /// The polynomial on the core of a simplex.
  const BPatch<Dim>& patch(int simplex) const { return patches_[simplex]; }
  /// The simplex that holds x (the lowest number on ties), -1 outside the domain.
  int find_simplex(const Point<Dim>& x) const;
  /// Whether x lies in the core of the simplex.
  bool in_core(int simplex, const Point<Dim>& x) const;
  /// Control values of a polynomial of at most the basis' degree from its polar form: exact.
  Eigen::VectorXd control_values(const PolarForm<Dim>& polar_form) const;

  int num_control_points() const override { return control_points_.count(); }
  int degree() const override { return net_.degree; }
  int smoothness() const override;
  bool contains(const Point<Dim>& x) const override { return find_simplex(x) >= 0; }
  Point<Dim> nearest_point(const Point<Dim>& x) const override;
  Box<Dim> bounds() const override;
  double measure() const override { return measure_; }
  double mean_edge_length() const override { return mean_edge_length_; }
  double edge_length(const Point<Dim>& x) const override;
  BasisValues<Dim> evaluate(const Point<Dim>& x, int derivatives = 0) const override;
  std::unique_ptr<SplineSampler<Dim>> sampler(
      const Eigen::Ref<const Eigen::MatrixXd>& control_points) const override;
  ControlPoints<Dim> greville_points() const override;
  /// Elements are cells of the arrangement of knot segments (KnotCells), `patch` = the triangle.
  std::vector<QuadratureElement<Dim>> quadrature(
      int polynomial_degree, int derivatives,
      const std::function<bool(int region, int patch)>& wanted = nullptr) const override;
  std::vector<std::pair<int, int>> couplings() const override;
  std::unique_ptr<DeterminantPieces<Dim>> determinant_pieces(
      const ControlPoints<Dim>& phi, const Matrix<Dim>& linear) const override;
  std::unique_ptr<BoundGrid<Dim>> bind(const Raster<Dim>& raster) const override;

 private:
  KnotNet<Dim> net_;
  KnotControlPoints<Dim> control_points_;
  std::vector<BPatch<Dim>> patches_;
  std::vector<std::vector<int>> ascending_;  // per simplex: its functions by control point
  std::unique_ptr<KnotLocator<Dim>> locator_;
  std::unique_ptr<TriangularBSplineEvaluator> evaluator_;    // 2D
  std::unique_ptr<TriangularBSplineQuadrature> quadrature_;  // 2D
  std::unique_ptr<SimplexSplineGraph<Dim>> graph_;           // 3D
  std::vector<std::vector<int>> neighbours_;                 // 3D: simplices that share a vertex
  NearestFacets<Dim> border_;
  double tie_ = 0.0, measure_ = 0.0, mean_edge_length_ = 0.0;
};

extern template class TriangularBSplineBasis<2>;
extern template class TriangularBSplineBasis<3>;

}  // namespace crease
