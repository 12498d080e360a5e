#pragma once

#include <array>

#include "Core/Point.h"
#include "Transforms/Splines/KnotVector.h"

namespace crease {

/// The control points that come nearest to the identity map.
template <int Dim>
struct NurbsIdentity {
  ControlPoints<Dim> control_points;  ///< along the axes, mm
  double error = 0;                   ///< NurbsBasis::affine_error
};

/// Along each axis the coefficients p_i of the spline that agrees with x W at the Greville abscissae, divided
/// by w_i: they are exact if x W is in the space. The error is sampled densely enough to see a term of one
/// degree more on every span; for W of several variables it is taken line by line of the net, which bounds
/// that of the whole: |sum_j N_j r_j / sum_j N_j W_j| <= max_j |r_j / W_j|.
template <int Dim>
NurbsIdentity<Dim> nearest_identity(const std::array<KnotVector, Dim>& axes,
                                    const Eigen::VectorXd& weights);

/// The largest ratio of W's Bezier ordinates along one axis within one span.
template <int Dim>
double largest_change(const std::array<KnotVector, Dim>& axes, const Eigen::VectorXd& weights);

}  // namespace crease
