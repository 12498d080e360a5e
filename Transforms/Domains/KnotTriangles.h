#pragma once

#include <array>
#include <span>

#include "Transforms/Domains/Polygon.h"

namespace crease {

/// The clouds of a triangle's three vertices, `degree` knots each; the knot of index `degree` is the vertex.
using TriangleClouds = std::array<std::span<const Point<2>>, 3>;

/// Smallest d(X_beta) / d(X_0) over all |beta| <= degree: positive if condition 1 holds, X_beta being the
/// triangle of knots t_{0,b_0}, t_{1,b_1}, t_{2,b_2}.
double smallest_knot_triangle(const TriangleClouds& clouds, int degree);

/// Area of the intersection of all X_beta, |beta| <= degree, over the triangle's own: positive if condition 2
/// holds. Needs condition 1.
double core_share(const TriangleClouds& clouds, int degree);

/// Whether the core has an inner point; tries the incentre first.
bool has_core(const TriangleClouds& clouds, int degree);

}  // namespace crease
