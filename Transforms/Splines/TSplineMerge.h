#pragma once

#include "Transforms/Splines/TSplineSimplification.h"

namespace crease {

/// Two patches side by side, with knots of their own, as one T-spline.
///
/// The first one's last line along `axis` and the second one's first are the same line of the plane; it becomes an
/// inner line that stands degree - smoothness times. Lines that run across it end there in T-junctions where the
/// other patch does not have them. Control points whose functions do not feel the common line stay as they
/// are; those near to it are fitted (`fit`). Where both maps agree along the line to the smoothness asked for,
/// the result is both of them up to rounding (max_error); else it joins them within max_error.
/// @param control_points  as many rows for both.
/// @param axis        0: the second lies behind the first along u; 1: along v.
/// @param smoothness  continuous derivatives across the line: 0 to degree - 1.
/// @throws InvalidInput when degrees, places or sizes do not fit.
TSplineApproximation merged(const TSplineBasis& first,
                            const Eigen::Ref<const Eigen::MatrixXd>& first_control_points,
                            const TSplineBasis& second,
                            const Eigen::Ref<const Eigen::MatrixXd>& second_control_points,
                            int axis, int smoothness);

}  // namespace crease
