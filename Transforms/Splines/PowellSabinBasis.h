#pragma once

#include <memory>
#include <span>
#include <vector>

#include "Transforms/Splines/NearestFacets.h"
#include "Transforms/Splines/PowellSabinPatch.h"
#include "Transforms/Splines/PowellSabinTriangles.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

template <int Dim>
class KnotLocator;

/// Normalized Powell-Sabin B-splines: all C1 functions that are quadratic on each of the small triangles
/// of a PowellSabinSplit, three for every vertex V.
///
/// Function j of V has value and gradient 0 at all other vertices. At V it is, with its gradient, the
/// barycentric coordinate j in the vertex' triangle (Q_1, Q_2, Q_3). So it vanishes outside the
/// triangles at V; it is not negative because the triangle holds the points of powell_sabin_points(); all
/// sum to 1; the control points of the identity are the corners Q_j; and control points are linear in value and
/// gradient: c_j = F(V) + grad F(V) (Q_j - V). All quadratics are contained.
///
/// With creases (PowellSabinCreases.h) the gradient may jump across lines: their vertices have four functions.
///
/// Unlike C1 quadratics on the triangles themselves they have functions enough to bend: on a known smooth
/// motion their bending energy converges to the motion's.
///
/// Source: P. Dierckx, "On calculating normalized Powell-Sabin B-splines", CAGD 15, 1997.
class PowellSabinBasis final : public SplineBasis<2> {
 public:
  /// @throws InvalidInput for what PowellSabinSplit and PowellSabinSides refuse, and for triangles of vertices
  /// (tetrahedra on creases) that are flat or do not hold their points; the message names the vertex.
  explicit PowellSabinBasis(PowellSabinNet net);
  /// With the triangles of place_powell_sabin().
  explicit PowellSabinBasis(SimplexMesh<2> mesh)
      : PowellSabinBasis(place_powell_sabin(std::move(mesh))) {}
  ~PowellSabinBasis() override;

  const PowellSabinNet& net() const { return net_; }
  const PowellSabinPatch& patch(int triangle) const { return patches_[triangle]; }
  /// First of the consecutive control points of a vertex.
  int first_control_point(int vertex) const { return first_[vertex]; }
  /// The triangle of the mesh that holds x (the lowest number on ties), -1 outside the domain.
  int find_simplex(const Point<2>& x) const;
  /// Control values of the spline with the values and gradients (1/mm) given at the vertices.
  /// @throws InvalidInput unless there is one of each per vertex.
  Eigen::VectorXd control_values(std::span<const double> values,
                                 std::span<const Vector<2>> gradients) const;

  int num_control_points() const override { return first_.back(); }
  int degree() const override { return 2; }
  int smoothness() const override { return 1; }
  bool contains(const Point<2>& x) const override { return find_simplex(x) >= 0; }
  Point<2> nearest_point(const Point<2>& x) const override;
  Box<2> bounds() const override;
  double measure() const override { return measure_; }
  double mean_edge_length() const override { return mean_edge_length_; }
  double edge_length(const Point<2>& x) const override;
  BasisValues<2> evaluate(const Point<2>& x, int derivatives = 0) const override;
  /// The corners of the vertices' triangles, vertex by vertex.
  ControlPoints<2> greville_points() const override;
  /// One element per triangle of the mesh, with the points of its small triangles; those in bands of creases
  /// by themselves.
  std::vector<QuadratureElement<2>> quadrature(
      int polynomial_degree, int derivatives,
      const std::function<bool(int region, int patch)>& wanted = nullptr) const override;
  std::vector<std::pair<int, int>> couplings() const override;
  std::unique_ptr<DeterminantPieces<2>> determinant_pieces(const ControlPoints<2>& phi,
                                                           const Matrix<2>& linear) const override;
  std::unique_ptr<BoundGrid<2>> bind(const Raster<2>& raster) const override;

 private:
  QuadratureElement<2> element(int triangle, int band, int polynomial_degree,
                               int derivatives) const;

  PowellSabinNet net_;
  std::vector<int> first_;  // control point of each vertex; and their number
  std::vector<PowellSabinPatch> patches_;
  std::unique_ptr<KnotLocator<2>> locator_;
  NearestFacets<2> border_;
  double measure_ = 0.0, mean_edge_length_ = 0.0;
};

}  // namespace crease
