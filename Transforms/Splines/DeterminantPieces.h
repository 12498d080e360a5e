#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <variant>
#include <vector>

#include "Core/Point.h"
#include "Transforms/Bernstein.h"

namespace crease {

/// det grad T on a simplex within one cell of a spline, where it is a polynomial.
template <int Dim>
struct SimplexPiece {
  using Form = BernsteinSimplex<Dim>;
  Form determinant;
  double error = 0;  ///< by which rounding may have changed a coefficient
  std::array<Point<Dim>, Dim + 1> points;

  static constexpr int kNumCorners = Dim + 1;
  std::vector<Point<Dim>> corners() const { return {points.begin(), points.end()}; }
  Point<Dim> corner(int j) const { return points[j]; }
  /// Longest edge, mm.
  double size() const;
  /// Halves it across its longest edge.
  std::pair<SimplexPiece, SimplexPiece> halves() const;
};

/// The same on a box, or parallelepiped: origin + edges t, 0 <= t_a <= 1.
template <int Dim>
struct BoxPiece {
  using Form = BernsteinBox<Dim>;
  Form determinant;
  double error = 0;
  Point<Dim> origin;
  Matrix<Dim> edges;  ///< a column per axis, mm

  static constexpr int kNumCorners = 1 << Dim;
  /// In 2D counter-clockwise if the edges are.
  std::vector<Point<Dim>> corners() const;
  Point<Dim> corner(int j) const;
  double size() const { return edges.colwise().norm().maxCoeff(); }
  std::pair<BoxPiece, BoxPiece> halves() const;
};

template <int Dim>
using DeterminantPiece = std::variant<SimplexPiece<Dim>, BoxPiece<Dim>>;

/// det grad T of a spline map, polynomial by polynomial. A patch is what quadrature() numbers as such: a
/// triangle, a knot span. Members may be called from several threads.
///
/// Of rational functions it is the numerator of det over the largest value of its positive denominator: that
/// has the sign of det, and where it is positive it is not above det.
template <int Dim>
class DeterminantPieces {
 public:
  virtual ~DeterminantPieces() = default;
  virtual int num_patches() const = 0;
  /// A number that det grad T is not below anywhere in the patch, from control points alone: cheap and
  /// often far too low; minus infinity where nothing cheap is known.
  virtual double rough_bound(int patch) const = 0;
  /// Pieces that cover the patch.
  virtual std::vector<DeterminantPiece<Dim>> pieces(int patch) const = 0;
};

/// By how much rounding may change a coefficient of det F when those of the entries of F, none larger
/// than `largest`, are wrong by up to `error`.
///
/// The product of Dim Bernstein forms takes fewer than 400 positive terms that sum to 1: their sums, in any
/// order, are off by less than 256 epsilon of the largest product; Dim! such products make det.
template <int Dim>
double determinant_error(double largest, double error);

/// det F on a simplex of a cell from the values of F = grad T at its domain points.
/// @param degree  of F.
/// @param error   of an entry of the values, absolute.
template <int Dim>
SimplexPiece<Dim> simplex_piece(const std::array<Point<Dim>, Dim + 1>& corners, int degree,
                                std::span<const Matrix<Dim>> jacobians, double error);

extern template struct SimplexPiece<2>;
extern template struct SimplexPiece<3>;
extern template struct BoxPiece<2>;
extern template struct BoxPiece<3>;

}  // namespace crease
