#pragma once

#include <span>

#include "Transforms/Splines/CardinalSystem.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

/// The cardinal thin-plate splines of n scattered centres c_i: B_i(c_j) is 1 for i = j and 0 otherwise,
/// and of all functions through such values B_i bends least over the whole plane or space.
///
///     B(x) = E U(|x - c|) + A^T (1, x),   U(r) = r^2 log r in 2D, -r in 3D
///
/// (CardinalSystem). They sum to 1 and sum_i c_i B_i(x) = x: the centres are the Greville points, and
/// control points are what the map adds at the centres. Every function reaches everywhere: the domain is
/// all of space, where a spline becomes affine far from the centres. bounds() is the box over which
/// quadrature() integrates; the bending of all of space is closed form, K = 8 pi E.
///
/// In 2D functions have continuous first derivatives, their second ones log r at the centres; in 3D
/// gradients jump at the centres, as -r does. At a centre the derivatives that have no limit are
/// those of a ring (2D) or sphere (3D) of 1e-6 of the centres' extent around it, on average.
///
/// Cost: O(n^3) to build, O(n^2) for all functions at a point, O(n) for a sum of them (sum()).
/// Sources: J. Duchon, "Splines minimizing rotation-invariant semi-norms in Sobolev spaces", 1977;
/// F. L. Bookstein, "Principal Warps", IEEE TPAMI 11(6), 1989; G. Wahba, "Spline Models for
/// Observational Data", SIAM, 1990.
template <int Dim>
class ThinPlateBasis final : public SplineBasis<Dim> {
 public:
  /// @param centres  mm, Dim + 1 to kMostCentres.
  /// @param bounds   mm; empty: the box of the centres.
  /// @throws InvalidInput as CentreFrame: the message names the centres that coincide.
  explicit ThinPlateBasis(const ControlPoints<Dim>& centres, const Box<Dim>& bounds = {});

  const ControlPoints<Dim>& centres() const { return centres_; }
  /// All functions at some points (Dim x q, mm), one column per point: n x q, as one matrix product.
  Eigen::MatrixXd values(const ControlPoints<Dim>& points) const;

  /// Values f at the centres of the smoothest spline near to given values y: the f with the least
  /// sum_i |f_i - y_i|^2 / v_i + int sum_ab |u_,ab|^2 dx over all of space; f_i = y_i where v_i = 0.
  /// @param values     y, one column per centre, any number of rows.
  /// @param variances  v_i >= 0, mm^(4 - Dim).
  Eigen::MatrixXd smoothed(const Eigen::Ref<const Eigen::MatrixXd>& values,
                           const Eigen::Ref<const Eigen::VectorXd>& variances) const;

  int num_control_points() const override { return static_cast<int>(centres_.cols()); }
  /// 2, that of the least smooth splines with as many continuous derivatives.
  int degree() const override { return 2; }
  int smoothness() const override { return Dim == 2 ? 1 : 0; }
  bool contains(const Point<Dim>& x) const override { return x.allFinite(); }
  Point<Dim> nearest_point(const Point<Dim>& x) const override { return x; }
  Box<Dim> bounds() const override { return bounds_; }
  double measure() const override { return bounds_.size().prod(); }
  /// The distance of neighbouring centres, if they filled the bounds evenly.
  double mean_edge_length() const override {
    return mean_centre_distance<Dim>(bounds_, centres_.cols());
  }
  /// The functions are no polynomials: rules of two points along each axis of every cell.
  int product_degree(int, int) const override { return 3; }
  /// At a centre, without derivatives, its own function alone.
  BasisValues<Dim> evaluate(const Point<Dim>& x, int derivatives = 0) const override;
  std::unique_ptr<SplineSum<Dim>> sum(
      const Eigen::Ref<const Eigen::MatrixXd>& control_points) const override;
  ControlPoints<Dim> greville_points() const override { return centres_; }
  /// Product Gauss rules on cells of half the centres' mean distance, gathered in patches of 4 cells a side.
  /// Not exact: second derivatives, which grow without bounds towards the centres, are held within a tenth
  /// of a cell of them. Integrals of squares of second derivatives are off by up to 1 % in 2D and 10 % in 3D
  /// (of first ones by 0.1 % and 1 %), whatever the degree asked for.
  std::vector<QuadratureElement<Dim>> quadrature(
      int polynomial_degree, int derivatives,
      const std::function<bool(int region, int patch)>& wanted = nullptr) const override;
  std::optional<Eigen::MatrixXd> bending_matrix() const override;
  std::vector<std::pair<int, int>> couplings() const override;
  /// Tables of all functions at all samples (SparseRowGrid) where these are few; else a cubic B-spline that
  /// interpolates them on a lattice of a sixth (2D) or third (3D) of the centres' mean distance (LatticeGrid).
  /// The lattice's error where centres move independently of each other: 0.2 % (2D), 1 % (3D) of their
  /// movement, root mean square, 2 % and 25 % beside a centre; a hundredth and a tenth of that where they
  /// move smoothly.
  std::unique_ptr<BoundGrid<Dim>> bind(const Raster<Dim>& raster) const override;

 private:
  int centre_at(const Point<Dim>& x) const;
  double bending_factor() const;

  ControlPoints<Dim> centres_;
  Box<Dim> bounds_;
  CentreFrame<Dim> frame_;
  CardinalSystem system_;
};

/// The thin-plate splines of a registration, with covering_centres(); bounds() are the raster's.
template <int Dim>
std::shared_ptr<const ThinPlateBasis<Dim>> covering_thin_plate(
    const Raster<Dim>& raster, double length, std::span<const Point<Dim>> landmarks = {});

extern template class ThinPlateBasis<2>;
extern template class ThinPlateBasis<3>;

}  // namespace crease
