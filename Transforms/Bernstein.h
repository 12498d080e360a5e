#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "Core/Point.h"

namespace crease {

/// A polynomial over a simplex in Bernstein form: with barycentric coordinates lambda of x,
///
///     p(x) = sum_{|beta| = degree} c_beta (degree! / beta!) lambda^beta.
///
/// p lies between the smallest and the largest coefficient, and at a corner it is the corner's own: what
/// makes the form good for bounds. Coefficients are in the order of multi_index_position.
/// Source: Farin, "Triangular Bernstein-Bezier patches", CAGD 3, 1986.
template <int Dim>
class BernsteinSimplex {
 public:
  /// @param coefficients  num_multi_indices<Dim>(degree) of them.
  BernsteinSimplex(int degree, Eigen::VectorXd coefficients)
      : degree_(degree), coefficients_(std::move(coefficients)) {}

  int degree() const { return degree_; }
  const Eigen::VectorXd& coefficients() const { return coefficients_; }
  Eigen::VectorXd& coefficients() { return coefficients_; }
  /// The value at corner j, 0 to Dim.
  double at_corner(int j) const;
  /// The two halves when the edge between corners j and k is cut in its middle m: with m instead of
  /// corner k, and with m instead of corner j.
  std::pair<BernsteinSimplex, BernsteinSimplex> split(int j, int k) const;

 private:
  int degree_;
  Eigen::VectorXd coefficients_;
};

/// The same over a box: p(t) = sum_i c_i prod_a B_{i_a}(t_a), t in [0, 1]^Dim, with the Bernstein polynomials
/// B_k(t) = C(d, k) t^k (1 - t)^(d - k) of a degree per axis. Coefficients run with the first axis fastest.
template <int Dim>
class BernsteinBox {
 public:
  using Degrees = std::array<int, Dim>;
  BernsteinBox(const Degrees& degrees, Eigen::VectorXd coefficients)
      : degrees_(degrees), coefficients_(std::move(coefficients)) {}

  const Degrees& degrees() const { return degrees_; }
  const Eigen::VectorXd& coefficients() const { return coefficients_; }
  Eigen::VectorXd& coefficients() { return coefficients_; }
  /// The value at the corner whose coordinate on axis a is bit a of `corner`.
  double at_corner(int corner) const;
  /// The lower and the upper half along an axis.
  std::pair<BernsteinBox, BernsteinBox> split(int axis) const;

 private:
  Degrees degrees_;
  Eigen::VectorXd coefficients_;
};

/// Products: every coefficient is a convex combination of products of the factors' coefficients. The
/// smaller degree over a simplex is at most 4, the larger one 4 (Dim - 1).
template <int Dim>
BernsteinSimplex<Dim> operator*(const BernsteinSimplex<Dim>& a, const BernsteinSimplex<Dim>& b);
template <int Dim>
BernsteinBox<Dim> operator*(const BernsteinBox<Dim>& a, const BernsteinBox<Dim>& b);

/// Points sum_j beta_j / degree v_j of a simplex (its centroid for degree 0) in the order of the
/// coefficients: values there determine a polynomial.
template <int Dim>
std::vector<Point<Dim>> domain_points(const std::array<Point<Dim>, Dim + 1>& corners, int degree);

/// Coefficients = matrix * values at the domain points. Its largest row sum of absolute values, the
/// factor by which errors of values grow, is 1, 1, 3, 10 and 23 for degrees 0 to 4 in the plane.
template <int Dim>
const Eigen::MatrixXd& coefficients_from_values(int degree);

/// Coefficients on one knot span = matrix * the control values of the degree + 1 uniform B-splines that do
/// not vanish there. No entry is negative and rows sum to 1, but for rounding.
const Eigen::MatrixXd& bernstein_from_bspline(int degree);

extern template class BernsteinSimplex<2>;
extern template class BernsteinSimplex<3>;
extern template class BernsteinBox<2>;
extern template class BernsteinBox<3>;

}  // namespace crease
