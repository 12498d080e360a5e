#pragma once

#include <array>

#include "Transforms/Splines/SplineBasis.h"
#include "Transforms/Splines/TensorBSplineFunctions.h"
#include "Transforms/Splines/TensorBSplineLattice.h"

namespace crease {

/// The lattice whose domain is exactly the pixels of a raster (half a pixel beyond the outer centres),
/// along its axes, with spans as near to the wanted size as fits.
/// @throws InvalidInput when the raster is empty or the size is not a positive number.
template <int Dim>
TensorLattice<Dim> covering_lattice(const Raster<Dim>& raster, double span_size_mm);

/// Products of uniform B-splines of degree 1 to 5 along the axes of a lattice.
///
/// The knots go on evenly beyond the domain (no repeated end knots), so that axis a has
/// spans_a + degree functions and B_i reaches over the spans i - degree .. i. Control points are
/// numbered with the first axis fastest. A cubic one is ITK's BSplineTransform: same functions, same
/// numbering; `control_raster()` is ITK's coefficient image.
///
/// Cost of a point: (degree + 1)^Dim terms. Source: de Boor, "A Practical Guide to Splines", 1978.
template <int Dim>
class TensorBSplineBasis final : public SplineBasis<Dim> {
 public:
  /// @throws InvalidInput for a degree outside 1..5, an axis without spans, a spacing that is not
  /// positive, a direction that is not orthonormal, or a number that is not finite.
  explicit TensorBSplineBasis(const TensorLattice<Dim>& lattice, int degree = 3);

  const TensorLattice<Dim>& lattice() const { return lattice_; }
  /// Functions per axis: spans + degree.
  std::array<int, Dim> net_size() const;
  /// The Greville points as a raster: control point (i, j[, k]) sits at the raster's sample.
  Raster<Dim> control_raster() const;

  /// The same domain with spans of half the size; its space contains this one.
  TensorBSplineBasis refined() const;
  /// Control points of the same function in refined(): knot insertion, exact up to rounding.
  /// @param control_points  one column per control point, any number of rows.
  Eigen::MatrixXd refine_control_points(
      const Eigen::Ref<const Eigen::MatrixXd>& control_points) const;

  int num_control_points() const override;
  int degree() const override { return degree_; }
  int smoothness() const override { return degree_ - 1; }
  /// The closed box, a billionth of a span wider against rounding.
  bool contains(const Point<Dim>& x) const override;
  Point<Dim> nearest_point(const Point<Dim>& x) const override;
  Box<Dim> bounds() const override;
  double measure() const override;
  double mean_edge_length() const override { return lattice_.spacing.mean(); }
  /// Along each axis a product of derivatives keeps up to the full degree of every factor.
  int product_degree(int factors, int) const override { return factors * degree_; }
  BasisValues<Dim> evaluate(const Point<Dim>& x, int derivatives = 0) const override;
  ControlPoints<Dim> greville_points() const override;
  /// One element per span, `patch` = its number, first axis fastest; the rule is a product of Gauss
  /// rules, exact for the degree given along every axis.
  std::vector<QuadratureElement<Dim>> quadrature(
      int polynomial_degree, int derivatives,
      const std::function<bool(int region, int patch)>& wanted = nullptr) const override;
  std::vector<std::pair<int, int>> couplings() const override;
  std::unique_ptr<DeterminantPieces<Dim>> determinant_pieces(
      const ControlPoints<Dim>& phi, const Matrix<Dim>& linear) const override;
  /// Rows are separable when the raster's axes run along the lattice's (TensorBSplineGrid); any other
  /// raster gets tables of weights (SparseRowGrid).
  std::unique_ptr<BoundGrid<Dim>> bind(const Raster<Dim>& raster) const override;

 private:
  struct Cell {
    std::array<int, Dim> span;
    Vector<Dim> local;  // in [0, 1]
  };
  Cell locate(const Point<Dim>& x) const;
  void fill_control_points(const std::array<int, Dim>& span, std::vector<int>& numbers) const;

  TensorLattice<Dim> lattice_;
  int degree_;
  TensorBSplineFunctions<Dim> functions_;
};

extern template class TensorBSplineBasis<2>;
extern template class TensorBSplineBasis<3>;

}  // namespace crease
