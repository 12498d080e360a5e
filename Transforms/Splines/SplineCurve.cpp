#include "Transforms/Splines/SplineCurve.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Transforms/Domains/ArcLength.h"
#include "Transforms/GaussRule.h"

namespace crease {
namespace {

constexpr int kDegree = 3;

/// Chord lengths from the first point, scaled to end at 1.
std::vector<double> chord_parameters(std::span<const Point<2>> points) {
  std::vector<double> u = arc_lengths(points);
  if (!(u.back() > 0)) throw InvalidInput("fit_curve: the points are all the same.");
  for (double& value : u) value /= u.back();
  u.back() = 1;
  return u;
}

}  // namespace

double SplineCurve::Jet::curvature() const {
  const double speed = first.norm();
  return speed > 0 ? cross(first, second) / (speed * speed * speed) : 0.0;
}

SplineCurve::SplineCurve(ControlPoints<2> control_points)
    : control_points_(std::move(control_points)) {
  if (control_points_.cols() <= kDegree) {
    throw InvalidInput("SplineCurve: a cubic needs at least 4 control points.");
  }
  knots_ = KnotVector::even(kDegree, 0, 1, num_control_points() - kDegree);
  lengths_ = {0};
  for (int s = 0; s < knots_.num_spans(); ++s) {
    const double end = knots_.span_begin(s) + knots_.span_length(s);
    lengths_.push_back(lengths_.back() + length_between(knots_.span_begin(s), end));
  }
}

SplineCurve::Jet SplineCurve::at(double u) const {
  const int span = knots_.find_span(u);
  const BSplineSegment segment = knots_.evaluate(span, u, 2);
  Jet jet;
  for (int r = 0; r <= kDegree; ++r) {
    const Point<2> c = control_points_.col(span + r);
    jet.point += segment.value[r] * c;
    jet.first += segment.first[r] * c;
    jet.second += segment.second[r] * c;
  }
  return jet;
}

double SplineCurve::length_between(double begin, double end) const {
  static const GaussRule rule = gauss_rule(8);
  double sum = 0;
  for (std::size_t q = 0; q < rule.points.size(); ++q) {
    sum += rule.weights[q] * at(begin + rule.points[q] * (end - begin)).first.norm();
  }
  return sum * (end - begin);
}

double SplineCurve::parameter_at(double arc_length) const {
  const PlaceBetween place = place_at_length(lengths_, arc_length);
  const int span = static_cast<int>(place.first);
  const double begin = knots_.span_begin(span), width = knots_.span_length(span);
  const double wanted = arc_length - lengths_[place.first];
  double u = begin + width * place.share;
  for (int step = 0; step < 8; ++step) {
    const double speed = at(u).first.norm();
    if (!(speed > 0)) break;
    const double change = (wanted - length_between(begin, u)) / speed;
    u = std::clamp(u + change, begin, begin + width);
    if (std::abs(change) < 1e-12) break;
  }
  return u;
}

FittedCurve fit_curve(std::span<const Point<2>> points, int num_control_points) {
  if (num_control_points <= kDegree || std::ssize(points) < num_control_points) {
    throw InvalidInput(message("fit_curve: ", points.size(), " points cannot determine ",
                               num_control_points, " control points (at least 4)."));
  }
  const std::vector<double> u = chord_parameters(points);
  const auto A = KnotVector::even(kDegree, 0, 1, num_control_points - kDegree).collocation(u);
  Eigen::MatrixX2d targets(std::ssize(points), 2);
  for (std::size_t i = 0; i < points.size(); ++i) targets.row(i) = points[i].transpose();
  const Eigen::SparseMatrix<double> normal = A.transpose() * A;
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(normal);
  if (factor.info() != Eigen::Success) {
    throw InvalidInput(message("fit_curve: the points leave some of ", num_control_points,
                               " control points undetermined; give more even points."));
  }
  const Eigen::MatrixX2d solution = factor.solve(A.transpose() * targets);
  FittedCurve fitted{SplineCurve(solution.transpose()), 0};
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto jet = fitted.curve.at(u[i]);
    const double across = cross(jet.first.normalized(), points[i] - jet.point);
    sum += across * across;
  }
  fitted.rms_mm = std::sqrt(sum / static_cast<double>(points.size()));
  return fitted;
}

FittedCurve fit_curve_within(std::span<const Point<2>> points, double rms_mm) {
  const int most = static_cast<int>(points.size() / 4);
  int n = 6;
  FittedCurve fitted = fit_curve(points, n);
  while (fitted.rms_mm > rms_mm && n < most) fitted = fit_curve(points, ++n);
  return fitted;
}

Polyline equal_arc_points(const SplineCurve& curve, int count) {
  Polyline points;
  for (int k = 0; k < count; ++k) {
    points.push_back(curve.at(curve.parameter_at(curve.length() * k / (count - 1))).point);
  }
  return points;
}

}  // namespace crease
