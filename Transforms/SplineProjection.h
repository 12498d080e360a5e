#pragma once

#include <Eigen/SparseCore>
#include <functional>

#include "Transforms/Splines/SplineBasis.h"

namespace crease {

/// Normal equations of the least-squares fit min int |u - sum_i phi_i B_i|^2 dx: M phi^T = rhs^T. For fits
/// with constraints, such as landmarks that must stay exact.
template <int Dim>
struct ProjectionSystem {
  Eigen::SparseMatrix<double> mass;  ///< n x n, both triangles
  ControlPoints<Dim> rhs;            ///< column i = int u B_i dx
};

/// Best approximation of a displacement in a spline space, and how good it is.
template <int Dim>
struct SplineProjection {
  ControlPoints<Dim> control_points;  ///< mm
  double rms_error = 0;               ///< over the domain, mm
  double max_error = 0;               ///< over the quadrature points, mm
};

/// A displacement in mm at x in mm. Called from several threads.
template <int Dim>
using DisplacementFunction = std::function<Vector<Dim>(const Point<Dim>& x)>;

template <int Dim>
ProjectionSystem<Dim> projection_system(const SplineBasis<Dim>& basis,
                                        const DisplacementFunction<Dim>& displacement);

/// Differences between a displacement and a spline at the quadrature points.
template <int Dim>
SplineProjection<Dim> projection_error(const SplineBasis<Dim>& basis,
                                       const ControlPoints<Dim>& control_points,
                                       const DisplacementFunction<Dim>& displacement);

/// The L2 projection on the basis' own cells: exact for displacements in its space. Use it to carry
/// a spline to another mesh or degree when the spaces do not nest.
/// @throws SolverError when the mass matrix is singular (functions that vanish on the whole domain).
template <int Dim>
SplineProjection<Dim> project(const SplineBasis<Dim>& basis,
                              const DisplacementFunction<Dim>& displacement);

/// Control points in `to` of the function sum_i phi_i B_i of `from`: by knot insertion when `to` is a
/// tensor lattice refined from `from` (any number of times), else by projection, continued beyond
/// `from`'s domain as SplineTransform does.
template <int Dim>
SplineProjection<Dim> transfer(const std::shared_ptr<const SplineBasis<Dim>>& from,
                               const ControlPoints<Dim>& control_points,
                               const SplineBasis<Dim>& to);

}  // namespace crease
