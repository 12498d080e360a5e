#include "Transforms/Splines/SplineCurve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "Core/Error.h"

namespace crease {
namespace {

constexpr double kPi = std::numbers::pi;

Polyline arc(double across, double up, double from, double to, int count) {
  Polyline points;
  for (int k = 0; k < count; ++k) {
    const double angle = from + (to - from) * k / (count - 1);
    points.emplace_back(across * std::cos(angle), up * std::sin(angle));
  }
  return points;
}

TEST(SplineCurve, DerivativesMatchCentralDifferences) {
  ControlPoints<2> c(2, 7);
  c << 0, 3, 5, 8, 9, 12, 11, 0, 4, -2, 1, 6, 3, 0;
  const SplineCurve curve(c);
  const double h = 1e-5;
  for (const double u : {0.11, 0.4, 0.83}) {
    const auto jet = curve.at(u);
    const auto before = curve.at(u - h), after = curve.at(u + h);
    EXPECT_LT((jet.first - (after.point - before.point) / (2 * h)).norm(), 1e-7);
    EXPECT_LT((jet.second - (after.first - before.first) / (2 * h)).norm(), 1e-6);
  }
}

TEST(SplineCurve, FitsItsOwnKindExactly) {
  ControlPoints<2> line(2, 4);
  line << 0, 3, 6, 9, 1, 1, 1, 1;
  const SplineCurve straight(line);
  Polyline points;
  for (int k = 0; k <= 40; ++k) points.push_back(straight.at(k / 40.0).point);
  const FittedCurve fitted = fit_curve(points, 9);
  EXPECT_LT(fitted.rms_mm, 1e-12);
  EXPECT_NEAR(fitted.curve.length(), 9, 1e-12);
  EXPECT_NEAR(fitted.curve.at(0.3).point.x(), 2.7, 1e-12);
}

TEST(SplineCurve, MeasuresArcLength) {
  const SplineCurve quarter = fit_curve(arc(40, 40, 0, kPi / 2, 400), 40).curve;
  EXPECT_NEAR(quarter.length(), 20 * kPi, 1e-5);
  for (const double share : {0.0, 0.21, 0.5, 0.97, 1.0}) {
    const Point<2> p = quarter.at(quarter.parameter_at(share * quarter.length())).point;
    EXPECT_NEAR(std::atan2(p.y(), p.x()), share * kPi / 2, 1e-6);
  }
}

// 97 and 50: perimeter of the half ellipse by the complete elliptic integral, 2 a E(e).
TEST(SplineCurve, MeasuresAHalfEllipse) {
  const double a = 97, b = 50;
  const double perimeter = 2 * a * std::comp_ellint_2(std::sqrt(1 - b * b / (a * a)));
  const FittedCurve fitted = fit_curve_within(arc(a, b, -kPi / 2, kPi / 2, 1500), 0.4);
  EXPECT_LE(fitted.rms_mm, 0.4);
  EXPECT_NEAR(fitted.curve.length(), perimeter, 0.002 * perimeter);
}

TEST(SplineCurve, EqualArcPointsAreEquallyFar) {
  const Polyline points = equal_arc_points(fit_curve(arc(60, 45, -1.4, 1.4, 600), 30).curve, 200);
  ASSERT_EQ(points.size(), 200u);
  const double first = (points[1] - points[0]).norm();
  for (std::size_t i = 1; i < points.size(); ++i) {
    EXPECT_NEAR((points[i] - points[i - 1]).norm(), first, 1e-4 * first);  // chords, not arcs
  }
}

TEST(SplineCurve, StopsAtTheFewestControlPointsThatDo) {
  auto points = arc(60, 45, -1.4, 1.4, 800);
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 0.2);
  for (auto& p : points) p += Vector<2>(noise(random), noise(random));
  const FittedCurve fitted = fit_curve_within(points, 0.25);
  EXPECT_LE(fitted.rms_mm, 0.25);
  EXPECT_LT(fitted.curve.num_control_points(), 12);
  EXPECT_EQ(fit_curve_within(points, 1e-9).curve.num_control_points(), 200);
}

TEST(SplineCurve, RefusesTooFewPoints) {
  EXPECT_THROW(fit_curve(arc(1, 1, 0, 1, 8), 9), InvalidInput);
  EXPECT_THROW(fit_curve(arc(1, 1, 0, 1, 8), 3), InvalidInput);
  EXPECT_THROW(fit_curve(Polyline(20, Point<2>(1, 2)), 6), InvalidInput);
  EXPECT_THROW(SplineCurve(ControlPoints<2>::Zero(2, 3)), InvalidInput);
}

}  // namespace
}  // namespace crease
