#pragma once

#include <array>

#include "Transforms/Splines/KnotVector.h"
#include "Transforms/Splines/ParameterBox.h"
#include "Transforms/Splines/SplineBasis.h"
#include "Transforms/Splines/TensorBSplineFunctions.h"

namespace crease {

template <int Dim>
struct BezierBox;

/// What a NURBS basis is made of.
template <int Dim>
struct NurbsNet {
  int degree = 3;                                   ///< 1 to 5, the same along all axes
  std::array<std::vector<double>, Dim> knots;       ///< clamped (KnotVector), mm along the axes
  Eigen::VectorXd weights;                          ///< positive, first axis fastest; empty = all 1
  Point<Dim> origin = Point<Dim>::Zero();           ///< where all knots are 0, mm
  Matrix<Dim> direction = Matrix<Dim>::Identity();  ///< orthonormal, column = axis
};

/// Whether a basis has to contain the affine maps, as every transform's must.
enum class AffineMaps { kRequired, kNotNeeded };

/// Rational functions R_i = w_i N_i / W, W = sum_i w_i N_i, of products N_i of B-splines on clamped,
/// not necessarily even knots ("non-uniform rational B-splines"). They sum to 1. A knot that stands r
/// times leaves degree - r continuous derivatives across it. Equal weights give plain B-splines.
///
/// Affine maps. Parameters are places here: the functions live on the domain itself. Then
/// sum_i g_i R_i = x asks for x_a W in the space of the N_i, and as W is in that space, this is so if
/// and only if W has a degree less along every axis, on every span: x_a W has one degree more than W and
/// is as smooth as W. So W must be a product-spline of degree n - 1 with the smoothness of the N_i: at a
/// knot that stands r times here it has r - 1 knots (KnotVector::one_degree_less). Where all inner
/// knots are simple, W is one polynomial of degree n - 1 in each variable on the whole domain; every
/// knot of W costs a double one here; for n = 1, W is constant. A single weight out of line
/// destroys the affine maps, and no choice of control points brings them back.
/// Such weights come from `elevated_weights`; given ones are checked (`affine_error`). Then g_i is the
/// coefficient of x W divided by w_i; with equal weights they are the Greville abscissae.
/// Geometry that needs rational functions but no affine maps (a shell's circle) says kNotNeeded: all else
/// works, greville_points() throws.
///
/// Cost of a point: (degree + 1)^Dim terms. Source: L. Piegl and W. Tiller, "The NURBS Book", 1997; the
/// condition on W is derived above.
template <int Dim>
class NurbsBasis final : public SplineBasis<Dim> {
 public:
  /// @throws InvalidInput for a degree outside 1..5, knots that KnotVector refuses, weights that are not
  /// positive or of the wrong number, a direction that is not orthonormal; and, unless not needed, weights
  /// that destroy affine maps: their functions' best identity misses x by more than 1e-12 of the domain.
  explicit NurbsBasis(NurbsNet<Dim> net, AffineMaps affine_maps = AffineMaps::kRequired);

  const NurbsNet<Dim>& net() const { return net_; }
  const std::array<KnotVector, Dim>& axes() const { return axes_; }
  const ParameterBox<Dim>& box() const { return box_; }
  /// Functions per axis.
  std::array<int, Dim> net_size() const;
  /// Whether weights differ.
  bool is_rational() const { return rational_; }
  /// Bound on |x - sum_i g_i R_i(x)| along an axis, in lengths of the axis.
  double affine_error() const { return affine_error_; }
  bool reproduces_affine_maps() const;

  int num_control_points() const override;
  int degree() const override { return net_.degree; }
  int smoothness() const override;
  bool contains(const Point<Dim>& x) const override { return box_.contains(x); }
  Point<Dim> nearest_point(const Point<Dim>& x) const override { return box_.nearest_point(x); }
  Box<Dim> bounds() const override { return box_.bounds(); }
  double measure() const override { return box_.measure(); }
  /// Mean length of the spans that are not empty.
  double mean_edge_length() const override;
  /// Along each axis a product keeps up to the full degree of every factor. Gauss rules are not exact for
  /// rational functions: where weights differ, this asks for 16 / log10(rho) degrees more, at most 60, which
  /// brings the error of energies below 1e-10. rho = (sqrt(q) + 1) / (sqrt(q) - 1) is the size of the ellipse
  /// round a span in which 1 / W is analytic, for W that changes evenly by q, the largest ratio of its Bezier
  /// ordinates along a span; 16 instead of 10 since powers of 1 / W occur (measured up to q = 2.4).
  int product_degree(int factors, int derivative) const override;
  BasisValues<Dim> evaluate(const Point<Dim>& x, int derivatives = 0) const override;
  /// @throws InvalidInput when the basis does not reproduce affine maps.
  ControlPoints<Dim> greville_points() const override;
  /// One element per span that is not empty; `patch` = its number among all spans, first axis fastest.
  std::vector<QuadratureElement<Dim>> quadrature(
      int polynomial_degree, int derivatives,
      const std::function<bool(int region, int patch)>& wanted = nullptr) const override;
  std::vector<std::pair<int, int>> couplings() const override;
  /// Null when the basis does not reproduce affine maps. The basis must outlive the result.
  std::unique_ptr<DeterminantPieces<Dim>> determinant_pieces(
      const ControlPoints<Dim>& phi, const Matrix<Dim>& linear) const override;
  /// As TensorBSplineBasis: separable rows for rasters along the axes (TensorBSplineGrid), tables for others.
  std::unique_ptr<BoundGrid<Dim>> bind(const Raster<Dim>& raster) const override;

 private:
  /// From B-splines to rational functions, in place.
  void divide_by_weight(BasisValues<Dim>& values) const;
  std::array<int, Dim> num_spans() const;
  void fill_control_points(const std::array<int, Dim>& span, std::vector<int>& numbers) const;
  /// The map with these control points on a patch; nothing where its span is empty.
  std::optional<BezierBox<Dim>> bezier_box(int patch,
                                           const ControlPoints<Dim>& control_points) const;

  NurbsNet<Dim> net_;
  std::array<KnotVector, Dim> axes_;
  ParameterBox<Dim> box_;
  TensorBSplineFunctions<Dim> functions_;
  bool rational_ = false;
  ControlPoints<Dim> greville_;  // along the axes
  double affine_error_ = 0;
  int extra_degree_ = 0;
};

/// The knots of the weight functions W that leave the affine maps in a basis with these knots.
template <int Dim>
std::array<KnotVector, Dim> weight_axes(const NurbsNet<Dim>& net);

/// The weights w_i of W = sum_j c_j M_j, M_j the products of B-splines on `weight_axes`: degree elevation.
/// @param coefficients  positive, one per function, first axis fastest. Then W and all w_i are positive.
/// @throws InvalidInput when they are not so.
template <int Dim>
Eigen::VectorXd elevated_weights(const NurbsNet<Dim>& net, const Eigen::VectorXd& coefficients);

/// A basis and the control points of the same map as before.
template <int Dim>
struct NurbsRefinement {
  std::shared_ptr<const NurbsBasis<Dim>> basis;
  Eigen::MatrixXd control_points;  ///< as many rows as before, one column per control point
};

/// Inserts knots along an axis: the same W and the same map, exact up to rounding.
/// @param control_points  one column per control point, any number of rows.
/// @param knots           mm along the axis, each inside the domain; repeated ones lower the smoothness.
/// @throws InvalidInput when the sizes do not fit or a knot would stand more than `degree` times.
template <int Dim>
NurbsRefinement<Dim> insert_knots(const NurbsBasis<Dim>& basis,
                                  const Eigen::Ref<const Eigen::MatrixXd>& control_points, int axis,
                                  const std::vector<double>& knots);

/// Halves every span along every axis.
template <int Dim>
NurbsRefinement<Dim> refined(const NurbsBasis<Dim>& basis,
                             const Eigen::Ref<const Eigen::MatrixXd>& control_points);

/// A net with even knots and equal weights whose domain is exactly the pixels of a raster (half a pixel
/// beyond the outer centres), along its axes, with spans as near to the wanted length as fits.
/// @throws InvalidInput when the raster is empty or the length is not a positive number.
template <int Dim>
NurbsNet<Dim> covering_nurbs(const Raster<Dim>& raster, double span_length_mm, int degree = 3);

extern template class NurbsBasis<2>;
extern template class NurbsBasis<3>;

}  // namespace crease
