#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "Transforms/Splines/BezierSegment.h"

namespace crease {

/// B-splines of one variable on clamped knots t_0 <= .. <= t_{m}: both ends are repeated degree + 1
/// times, inner knots at most degree times. At a knot that stands r times the splines have degree - r
/// continuous derivatives.
///
/// Function i lives on [t_i, t_{i + degree + 1}]. Span s is [t_{s + degree}, t_{s + degree + 1}], where
/// the functions s .. s + degree do not vanish; spans between repeated knots are empty.
/// Every span keeps its Bezier ordinates. Source: C. de Boor, "A Practical Guide to Splines", 1978.
class KnotVector {
 public:
  KnotVector() = default;
  /// @param degree  0 to 5.
  /// @throws InvalidInput when the knots are not as above, or not finite; it names the knot at fault.
  KnotVector(int degree, std::vector<double> knots);
  /// Even spans, no inner knot repeated. @throws InvalidInput when there are no spans or end <= begin.
  static KnotVector even(int degree, double begin, double end, int spans);

  int degree() const { return degree_; }
  const std::vector<double>& knots() const { return knots_; }
  double begin() const { return knots_.front(); }
  double end() const { return knots_.back(); }
  int num_functions() const { return static_cast<int>(knots_.size()) - degree_ - 1; }
  int num_spans() const { return num_functions() - degree_; }
  double span_begin(int span) const { return knots_[span + degree_]; }
  double span_length(int span) const { return knots_[span + degree_ + 1] - span_begin(span); }
  /// The span, never an empty one, that holds u: at a knot the one to its right, at the end the last.
  /// Beyond the ends the outer ones.
  int find_span(double u) const;
  /// Bezier ordinates of the r-th function of a span that is not empty.
  const BSplineSegment::Values& ordinates(int span, int r) const {
    return ordinates_[span * (degree_ + 1) + r];
  }
  /// The functions of a span at u (within it) with derivatives by u.
  BSplineSegment evaluate(int span, double u, int derivatives) const;
  /// Means of the inner knots of every function: sum_i g_i N_i(u) = u. For degree 0 the middles.
  std::vector<double> greville_abscissae() const;
  /// Continuous derivatives everywhere: degree less the largest inner multiplicity (degree without
  /// inner knots).
  int smoothness() const;

  /// The same with one knot more. @throws InvalidInput when it is outside or repeated too often.
  KnotVector with_knot(double u) const;
  /// (functions of with_knot(u)) x (functions): the coefficients of the same spline there.
  /// Source: W. Boehm, "Inserting new knots into B-spline curves", 1980.
  Eigen::SparseMatrix<double, Eigen::RowMajor> insertion(double u) const;
  /// The knots whose splines of one degree less are smooth wherever these are: every distinct knot once
  /// less. Their products with u are splines of this space.
  KnotVector one_degree_less() const;
  /// abscissae.size() x functions: the functions' values there.
  Eigen::SparseMatrix<double> collocation(const std::vector<double>& abscissae) const;

 private:
  int degree_ = 0;
  std::vector<double> knots_ = {0, 1};
  std::vector<BSplineSegment::Values> ordinates_;
};

}  // namespace crease
