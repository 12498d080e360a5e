#pragma once

#include <array>
#include <span>
#include <vector>

#include "Core/Point.h"

namespace crease {

/// Points and weights over a convex cell: sum_i weights[i] f(points[i]) is the integral of f.
struct CellRule {
  std::vector<Point<2>> points;  ///< inside the cell
  std::vector<double> weights;   ///< positive, sum = the cell's area
};

/// A rule that is exact for polynomials of the degree given (0 to 20) over a convex polygon.
///
/// Degree 0 and 1 take the centroid; degree 2 takes three points, c + sqrt(2) L e_k with L L^T the
/// polygon's covariance and e_k at 120 degrees, which has the polygon's moments up to degree 2 (the
/// ellipse lies inside every convex body: Kannan, Lovasz, Simonovits, 1995). Higher degrees fan the
/// polygon into triangles.
CellRule cell_rule(std::span<const Point<2>> polygon, int degree);
/// The same into an existing rule, whose memory it uses again.
void set_cell_rule(std::span<const Point<2>> polygon, int degree, CellRule& rule);

/// Barycentric points and weights (sum 1) of a rule for triangles.
struct TriangleRule {
  std::vector<std::array<double, 3>> points;
  std::vector<double> weights;
};

/// Fully symmetric rules up to degree 8 (Dunavant, "High degree efficient symmetrical Gaussian
/// quadrature rules for the triangle", IJNME 21, 1985; digits refined by Newton's method), above that
/// products of Gauss rules on the collapsed square.
const TriangleRule& triangle_rule(int degree);

}  // namespace crease
