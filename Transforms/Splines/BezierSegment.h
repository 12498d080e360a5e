#pragma once

#include <span>

#include "Transforms/Splines/TensorBSplineSegments.h"

namespace crease {

/// The Bernstein polynomials b_r(s) = binomial(n, r) s^r (1 - s)^(n - r), r = 0 .. n, and up to two
/// derivatives by s. Entries beyond the degree are 0.
/// @param degree  n, 0 to 5.
BSplineSegment bernstein_segment(int degree, double s, int derivatives);

/// Bezier ordinates of the one B-spline N with the knots given, on an interval that lies within one of
/// its knot spans: N(begin + s (end - begin)) = sum_r ordinate[r] b_r(s). They are not negative; all 0
/// where N vanishes.
///
/// Ordinate r is the polynomial's blossom at n - r times `begin` and r times `end`, found by de Boor's
/// algorithm. Source: L. Ramshaw, "Blossoming: a connect-the-dots approach to splines", 1987;
/// M. Borden et al., "Isogeometric finite element data structures based on Bezier extraction of NURBS", 2011.
/// @param knots  n + 2 of them, ascending.
BSplineSegment::Values bezier_ordinates(std::span<const double> knots, double begin, double end);

/// sum_r ordinates[r] b_r: value, and the derivatives that `bernstein` holds, divided by powers of the
/// interval's length: by mm, where the interval is in mm.
struct BezierJet {
  double value = 0, first = 0, second = 0;
};
BezierJet bezier_jet(const BSplineSegment::Values& ordinates, const BSplineSegment& bernstein,
                     double length);

}  // namespace crease
