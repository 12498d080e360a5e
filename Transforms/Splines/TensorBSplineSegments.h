#pragma once

#include <array>

namespace crease {

inline constexpr int kMaxTensorDegree = 5;

/// The degree + 1 uniform B-splines that do not vanish on one knot span, in the span's own coordinate
/// s in [0, 1]. Entry r belongs to the r-th of them from the left. Entries beyond the degree are 0.
struct BSplineSegment {
  using Values = std::array<double, kMaxTensorDegree + 1>;
  Values value{};
  Values first{};   ///< d/ds
  Values second{};  ///< d^2/ds^2
};

/// Values and, if asked for, one or two derivatives at s by the recurrence
///     N^d_r(s) = ( (s + d - r) N^{d-1}_{r-1}(s) + (1 + r - s) N^{d-1}_r(s) ) / d,
///     dN^d_r/ds = N^{d-1}_{r-1} - N^{d-1}_r.
/// @param degree       1 to 5.
/// @param derivatives  0 to 2; those not asked for stay 0.
BSplineSegment bspline_segment(int degree, double s, int derivatives);

/// Coefficients by powers of s: entry [t][r] is that of s^t in the r-th function.
using BSplinePolynomials =
    std::array<std::array<double, kMaxTensorDegree + 1>, kMaxTensorDegree + 1>;
BSplinePolynomials bspline_polynomials(int degree);

}  // namespace crease
