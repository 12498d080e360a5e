#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "Core/Box.h"
#include "Core/Point.h"
#include "Core/Raster.h"
#include "Transforms/BlockHessian.h"

namespace crease {

template <int Dim>
class BoundGrid;
template <int Dim>
class DeterminantPieces;
template <int Dim>
class SplineSampler;

/// Number of distinct second derivatives: xx, xy, yy (2D); xx, xy, xz, yy, yz, zz (3D).
template <int Dim>
inline constexpr int kNumSecondDerivatives = Dim*(Dim + 1) / 2;

/// The basis functions that do not vanish at one point.
template <int Dim>
struct BasisValues {
  std::vector<int> control_points;  ///< their control points, each once, ascending
  Eigen::VectorXd values;           ///< B_i(x); they sum to 1
  Eigen::Matrix<double, Dim, Eigen::Dynamic> gradients;  ///< 1/mm; empty unless asked for
  Eigen::Matrix<double, kNumSecondDerivatives<Dim>, Eigen::Dynamic> hessians;  ///< 1/mm^2; likewise
};

/// Points of Gauss rules on cells in which every basis function is one polynomial: one cell, or some
/// small ones of the same patch and bands.
template <int Dim>
struct QuadratureElement {
  std::vector<int> control_points;  ///< k functions that do not vanish in all of the cells
  int region = -1;  ///< body label of the patch that holds the cells; -1: the basis has no regions
  int patch = -1;   ///< number of that patch (triangle, knot span)
  bool in_band =
      false;  ///< lies in the bending gap of a crease (feature-line theory: it carries no bending)
  bool in_two_sided_band = false;  ///< same, of a crease without a body side: rigidity skips it too
  Eigen::Matrix<double, Dim, Eigen::Dynamic> points;  ///< Dim x q, mm
  Eigen::VectorXd weights;                            ///< q, sum = the cells' area or volume
  Eigen::MatrixXd values;                             ///< k x q
  std::vector<Eigen::MatrixXd> gradients;             ///< Dim matrices k x q, or empty
  std::vector<Eigen::MatrixXd> hessians;  ///< kNumSecondDerivatives matrices k x q, or empty
};

/// u(x) = sum_i phi_i B_i(x) for control points that stay as they are.
template <int Dim>
class SplineSum {
 public:
  virtual ~SplineSum() = default;
  /// Row a belongs to coordinate a of phi; column 0 holds u, then, for derivatives up to 1 and 2, Dim
  /// columns its gradient and kNumSecondDerivatives columns its second derivatives.
  virtual Eigen::MatrixXd evaluate(const Point<Dim>& x, int derivatives) const = 0;
};

/// Basis functions B_i on a domain that sum to 1 and contain the affine maps: what a spline transform
/// is made of. Immutable; one basis may serve many transforms and threads.
template <int Dim>
class SplineBasis {
 public:
  virtual ~SplineBasis() = default;
  virtual int num_control_points() const = 0;
  virtual int degree() const = 0;
  /// Continuous derivatives away from creases: degree - 1 unless built with less.
  virtual int smoothness() const = 0;
  /// Whether x lies in the closed domain.
  virtual bool contains(const Point<Dim>& x) const = 0;
  /// The domain's point nearest to x (x itself inside): from there maps continue outside the domain.
  /// Unless overridden it is a point of the border towards x, near to the nearest one: the box's for
  /// domains that fill their box, else the last on the way from x to the nearest Greville point inside.
  virtual Point<Dim> nearest_point(const Point<Dim>& x) const;
  virtual Box<Dim> bounds() const = 0;
  /// Area (mm^2) or volume (mm^3) of the domain.
  virtual double measure() const = 0;
  /// Mean edge length of the patches, mm.
  virtual double mean_edge_length() const = 0;
  /// Mean edge length of the patch that holds x, mm; of all unless they differ.
  virtual double edge_length(const Point<Dim>&) const { return mean_edge_length(); }
  /// Degree to ask of quadrature() for integrals of products of this many derivatives of that order.
  virtual int product_degree(int factors, int derivative) const {
    return std::max(0, factors * (degree() - derivative));
  }
  /// The functions at x, with derivatives up to the order asked for (0, 1, 2). On lines where a
  /// derivative jumps it is a one-sided limit from within the domain, the same for all functions.
  /// @throws InvalidInput when x is outside the domain.
  virtual BasisValues<Dim> evaluate(const Point<Dim>& x, int derivatives = 0) const = 0;
  /// Control points bound once, for many x: what a basis offers whose functions cost more one by one than
  /// their sum does. Null: evaluate() is the way.
  /// @param control_points  one column per control point, any number of rows.
  virtual std::unique_ptr<SplineSum<Dim>> sum(
      const Eigen::Ref<const Eigen::MatrixXd>& /*control_points*/) const {
    return nullptr;
  }
  /// Control points bound once, for many x at a time; the basis must outlive it. Null unless overridden.
  /// @param control_points  one column per control point, 2 or 3 rows.
  virtual std::unique_ptr<SplineSampler<Dim>> sampler(
      const Eigen::Ref<const Eigen::MatrixXd>& control_points) const;
  /// Control points of the identity map (Greville points): sum_i g_i B_i(x) = x.
  virtual ControlPoints<Dim> greville_points() const = 0;
  /// Cells that cover the domain, each with a Gauss rule exact for polynomials of the degree given, and
  /// the functions' derivatives up to the order given. `wanted(region, patch)` chooses patches; null = all.
  virtual std::vector<QuadratureElement<Dim>> quadrature(
      int polynomial_degree, int derivatives,
      const std::function<bool(int region, int patch)>& wanted = nullptr) const = 0;
  /// int sum_ab B_i,ab B_k,ab dx in closed form, n x n, for a basis whose functions are defined in all of
  /// space and bend there as a whole; nullopt: integrate by quadrature().
  virtual std::optional<Eigen::MatrixXd> bending_matrix() const { return std::nullopt; }
  /// Pairs i <= k of control points whose functions overlap: the sparsity of any local energy.
  virtual std::vector<std::pair<int, int>> couplings() const = 0;
  /// The same as a pattern, made at the first call and kept.
  std::shared_ptr<const HessianPattern> pattern() const;
  /// det grad T of T(x) = linear x + sum_i phi_i B_i(x), polynomial by polynomial, for certificates. All
  /// arguments and the basis must outlive the result. Null unless overridden: not available.
  /// @param phi  Dim x num_control_points(), mm.
  virtual std::unique_ptr<DeterminantPieces<Dim>> determinant_pieces(
      const ControlPoints<Dim>& phi, const Matrix<Dim>& linear) const;
  /// Prepares the basis for all samples of a raster. Samples outside the domain are not covered.
  virtual std::unique_ptr<BoundGrid<Dim>> bind(const Raster<Dim>& raster) const = 0;

 private:
  struct KeptPattern {
    std::once_flag made;
    std::shared_ptr<const HessianPattern> pattern;
  };
  std::shared_ptr<KeptPattern> kept_pattern_ = std::make_shared<KeptPattern>();
};

extern template class SplineBasis<2>;
extern template class SplineBasis<3>;

}  // namespace crease
