#pragma once

#include "Transforms/Splines/TSplineBasis.h"

namespace crease {

/// A T-spline of fewer control points.
struct TSplineApproximation {
  std::shared_ptr<const TSplineBasis> basis;
  Eigen::MatrixXd control_points;  ///< as many rows as before, one column per control point
  /// Bound on the distance between the two maps, in units of the control points.
  double max_error = 0;
};

/// Removes superfluous control points: the reverse of refinement, within a tolerance.
///
/// An edge is superfluous where the map's polynomials on its sides continue each other. So every edge is
/// judged by the jumps of the map's derivatives across it, each times its share of a Taylor step over the
/// neighbouring elements; of repeated lines as many stay as the lowest derivative that jumps asks for.
/// What stays is completed to an analysis-suitable mesh, and the map is fitted there (`fit`). If the fit
/// misses the tolerance, edges are judged more strictly, until it holds.
///
/// This undoes a refinement of a tensor mesh entirely. Of a mesh that had T-junctions before, those added edges
/// stay that lie on their extensions: the map bends across these, too.
/// @param control_points  one column per control point, any number of rows.
/// @param tolerance  > 0, largest distance between the maps; far above rounding (1e-12 of the control points).
/// @throws InvalidInput when the sizes do not fit or the tolerance is not positive.
TSplineApproximation simplified(const TSplineBasis& basis,
                                const Eigen::Ref<const Eigen::MatrixXd>& control_points,
                                double tolerance);

}  // namespace crease
