#pragma once

#include "Optimizers/LinearConstraints.h"
#include "Transforms/SplineProjection.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {

/// Control points of the piecewise quadratic displacement that takes the given values at the vertices and in
/// the middle of the edges, mm. Between them it is that quadratic where knots are collapsed: everywhere with
/// KnotOptions::collapse_all (Lagrange's interpolant), on the border with BorderRule::kCollapsed.
/// @throws InvalidInput unless the basis is of degree 2.
ControlPoints<2> interpolate_on_edges(const TriangularBSplineBasis<2>& basis,
                                      const DisplacementFunction<2>& displacement);

/// Holds the whole border of a body where that quadratic is, for run_load_steps(): a row for each vertex and
/// each edge of the border, with a single entry.
/// @param basis  with the knots of its border collapsed.
/// @throws InvalidInput unless the basis is of degree 2.
LinearConstraints border_constraints(const TriangularBSplineBasis<2>& basis,
                                     const ControlPoints<2>& control_points);

}  // namespace crease
