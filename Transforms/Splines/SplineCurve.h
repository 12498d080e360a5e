#pragma once

#include <span>
#include <vector>

#include "Core/Point.h"
#include "Transforms/Domains/Polygon.h"
#include "Transforms/Splines/KnotVector.h"

namespace crease {

/// An open cubic B-spline curve in the plane, clamped, with even knots on [0, 1].
class SplineCurve {
 public:
  /// Point and derivatives by the parameter.
  struct Jet {
    Point<2> point = Point<2>::Zero();     ///< mm
    Vector<2> first = Vector<2>::Zero();   ///< mm
    Vector<2> second = Vector<2>::Zero();  ///< mm
    /// (x' y'' - y' x'') / |(x', y')|^3, 1/mm: positive where the curve turns from +x towards +y.
    double curvature() const;
  };

  /// @param control_points  at least 4, mm.
  explicit SplineCurve(ControlPoints<2> control_points);

  int num_control_points() const { return static_cast<int>(control_points_.cols()); }
  /// u in [0, 1].
  Jet at(double u) const;
  double length() const { return lengths_.back(); }  ///< mm
  /// The parameter after an arc length in mm, 0 .. length(), by Newton steps.
  double parameter_at(double arc_length) const;

 private:
  double length_between(double begin, double end) const;  // within one span

  KnotVector knots_;
  ControlPoints<2> control_points_;
  std::vector<double> lengths_;  // from 0 to the knots
};

/// A least-squares fit and how far the points are from it.
struct FittedCurve {
  SplineCurve curve;
  double rms_mm = 0;  ///< of the points' distances, measured across the curve
};

/// The curve with a number of control points that is nearest to the points, which are taken at parameters in
/// proportion to their chord lengths.
/// @throws InvalidInput when there are fewer than 4 control points or fewer points than control points.
FittedCurve fit_curve(std::span<const Point<2>> points, int num_control_points);

/// The one with the fewest control points (from 6) whose rms distance is at most `rms_mm`; the last one tried
/// when a control point for every 4 points is not enough.
/// @throws InvalidInput for fewer than 6 points.
FittedCurve fit_curve_within(std::span<const Point<2>> points, double rms_mm);

/// `count` points at equal arc length, ends included.
Polyline equal_arc_points(const SplineCurve& curve, int count);

}  // namespace crease
