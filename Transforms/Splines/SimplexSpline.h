#pragma once

#include <span>
#include <vector>

#include "Core/Point.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

/// Value and derivatives of a function at a point. Order of the second derivatives: xx, xy, yy (2D),
/// xx, xy, xz, yy, yz, zz (3D).
template <int Dim>
struct SplineJet {
  using SecondDerivatives = Eigen::Matrix<double, kNumSecondDerivatives<Dim>, 1>;
  double value = 0.0;
  Vector<Dim> gradient = Vector<Dim>::Zero();
  SecondDerivatives hessian = SecondDerivatives::Zero();
};

/// Index of d^2/dx_a dx_b among the second derivatives.
template <int Dim>
constexpr int second_derivative_index(int a, int b) {
  if (a > b) return second_derivative_index<Dim>(b, a);
  return a * Dim - a * (a - 1) / 2 + b - a;
}

/// The simplex spline M(u | V) of degree n = |V| - Dim - 1, 0 to 5, with its derivatives:
///
///     n = 0:  M = 1 / |det V| inside the simplex V
///     n > 0:  M(u | V) = sum_j lambda_j(u | W) M(u | V \ {w_j}),  W = the Dim + 1 knots of V with the
///             largest determinant;      grad M = n sum_j grad lambda_j M(u | V \ {w_j}).
///
/// Repeated knots count each time; sets without volume contribute 0. Where M jumps it is the limit
/// lim M(u + e d_0 + e^2 d_1 + ...), e -> 0+, along the directions. The integral of M is
/// n! / (n + Dim)!.
///
/// This is the plain recurrence, about 4^n terms: the reference for the faster evaluators.
/// Source: Dahmen, Micchelli, Seidel, Math. Comp. 59, 1992.
/// @throws InvalidInput for a degree outside 0..5 or numbers that are not finite.
template <int Dim>
SplineJet<Dim> simplex_spline(std::span<const Point<Dim>> knots, const Point<Dim>& u,
                              std::span<const Vector<Dim>> directions);

/// The flag of directions by which all functions at u agree on which side of a knot line u lies: the
/// first leads towards `inside`, the others complete a basis.
template <int Dim>
std::vector<Vector<Dim>> flag_towards(const Point<Dim>& inside, const Point<Dim>& u);

/// The Dim + 1 knots whose simplex has the largest |determinant|.
template <int Dim>
struct SplitSet {
  std::array<int, Dim + 1> position{};  ///< in the list of knots, ascending
  double determinant = 0.0;  ///< of these, in this order; 0 when the knots span no volume
};

/// @param knots  at least Dim + 1 points. A largest determinant below 1e-10 diameter^Dim is none.
template <int Dim>
SplitSet<Dim> largest_split_set(std::span<const Point<Dim>> knots);

/// grad lambda_j of the simplex, one column per corner.
template <int Dim>
Eigen::Matrix<double, Dim, Dim + 1> barycentric_gradients(
    const std::array<Point<Dim>, Dim + 1>& corners);

}  // namespace crease
