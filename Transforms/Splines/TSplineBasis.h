#pragma once

#include "Transforms/Splines/ParameterBox.h"
#include "Transforms/Splines/SplineBasis.h"
#include "Transforms/Splines/TMesh.h"

namespace crease {

/// The T-spline of an analysis-suitable T-mesh in the plane: functions B_i(u, v) = N[knots of u](u)
/// N[knots of v](v), one per vertex, whose knots TMesh finds by rays.
///
/// All weights are 1 and nothing is divided: on analysis-suitable meshes the B_i sum to 1, are linearly independent
/// and contain the polynomials of degree n in u and v. So the basis is polynomial between its lines, it
/// reproduces affine maps with the Greville points (means of the n inner knots), and Gauss
/// rules on its Bezier elements are exact. Meshes that are not analysis-suitable are refused: their sum
/// may differ from 1, and rational functions would restore the sum but not the affine maps.
///
/// Bezier elements are the faces of the mesh with the T-junctions' extensions drawn in. Each
/// keeps, for every function that lives there, the Bezier ordinates of both factors: evaluation costs
/// 2 (n + 1) products per function. (n + 1)^2 functions live on an element of a tensor mesh, and of others.
///
/// Sources: as TMesh; M. Scott et al., "Isogeometric finite element data structures based on Bezier
/// extraction of T-splines", 2011.
class TSplineBasis final : public SplineBasis<2> {
 public:
  /// Knots are mm along the axes.
  /// @param origin     where all knots are 0, mm.
  /// @param direction  orthonormal, column = axis.
  /// @throws InvalidInput when the mesh is not analysis-suitable (it names the two T-junctions), an inner line
  /// stands more than degree times, or the direction is not orthonormal.
  explicit TSplineBasis(TMesh mesh, const Point<2>& origin = Point<2>::Zero(),
                        const Matrix<2>& direction = Matrix<2>::Identity());

  const TMesh& mesh() const { return mesh_; }
  const ParameterBox<2>& box() const { return box_; }
  /// A basis in the same place.
  std::shared_ptr<const TSplineBasis> on(TMesh mesh) const;

  /// A Bezier element, in lines of the mesh and in mm along the axes.
  struct Element {
    TFace face;
    Vector<2> lower, upper;
    std::vector<int> functions;  ///< that do not vanish on it, ascending
    /// Ordinates of their factors along u and v.
    std::vector<std::array<BSplineSegment::Values, 2>> ordinates;
  };
  /// Those of positive size; their numbers are the patches of quadrature().
  const std::vector<Element>& elements() const { return elements_; }
  /// The element that holds a point given along the axes; on lines the one to the right and above.
  int find_element(const Vector<2>& u) const;

  int num_control_points() const override { return static_cast<int>(greville_.cols()); }
  int degree() const override { return mesh_.degree(); }
  int smoothness() const override { return smoothness_; }
  bool contains(const Point<2>& x) const override { return box_.contains(x); }
  Point<2> nearest_point(const Point<2>& x) const override { return box_.nearest_point(x); }
  Box<2> bounds() const override { return box_.bounds(); }
  double measure() const override { return box_.measure(); }
  /// Mean of the Bezier elements' sides.
  double mean_edge_length() const override;
  double edge_length(const Point<2>& x) const override;
  /// Along each axis a product of derivatives keeps up to the full degree of every factor.
  int product_degree(int factors, int) const override { return factors * degree(); }
  BasisValues<2> evaluate(const Point<2>& x, int derivatives = 0) const override;
  ControlPoints<2> greville_points() const override;
  /// One element per Bezier element; the rule is a product of Gauss rules, exact for the degree given along both axes.
  std::vector<QuadratureElement<2>> quadrature(
      int polynomial_degree, int derivatives,
      const std::function<bool(int region, int patch)>& wanted = nullptr) const override;
  std::vector<std::pair<int, int>> couplings() const override;
  std::unique_ptr<DeterminantPieces<2>> determinant_pieces(const ControlPoints<2>& phi,
                                                           const Matrix<2>& linear) const override;
  std::unique_ptr<BoundGrid<2>> bind(const Raster<2>& raster) const override;

 private:
  void make_elements(const std::vector<TPoint>& vertices);
  void multiply(const Element& element, const std::array<BSplineSegment, 2>& bernstein,
                int derivatives, BasisValues<2>& result) const;

  TMesh mesh_;
  ParameterBox<2> box_;
  ControlPoints<2> greville_;  // along the axes
  int smoothness_;
  std::vector<Element> elements_;
  std::vector<int> element_of_cell_;  // per cell between lines, u fastest; -1: of no size
  Matrix<3> second_to_space_;
};

}  // namespace crease
