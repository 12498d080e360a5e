#pragma once

#include <Eigen/SparseCore>

#include "Transforms/Splines/TMesh.h"

namespace crease {

/// A T-mesh whose functions contain those of a coarser one.
struct TNesting {
  TMesh mesh;
  /// (coarse functions) x (functions of mesh), entries >= 0: coarse B_i = sum_j transfer(i, j) B_j. Control
  /// points of the same map are P_fine = P_coarse * transfer.
  Eigen::SparseMatrix<double> transfer;
};

/// The finer mesh, with further edges where its space would not contain the coarse one: local refinement.
///
/// Each coarse function is split by knot insertion wherever the finer mesh knows knots that it lacks. Where
/// it has knots that the mesh lacks, or a part has no vertex, the mesh gets the edge. Between these
/// rounds the mesh is made analysis-suitable. The full grid of all lines ends it at the latest. All splitting is
/// exact up to rounding.
///
/// Source: T. Sederberg et al., "T-spline simplification and local refinement", 2004; M. Scott et al.,
/// "Local refinement of analysis-suitable T-splines", 2012.
/// @param coarse  analysis-suitable.
/// @param finer   of the same degree, on all lines of the coarse one and perhaps others; it gets all edges of
///                the coarse one.
/// @throws InvalidInput when degrees differ or lines are missing.
TNesting nested(const TMesh& coarse, TMesh finer);

/// A mesh whose functions contain those of two others.
struct TCommonMesh {
  TMesh mesh;
  Eigen::SparseMatrix<double> first, second;  ///< as TNesting::transfer
};

/// @param first, second  analysis-suitable, of one degree; all lines of the first one are the second's, too.
TCommonMesh common_refinement(const TMesh& first, const TMesh& second);

/// Control points of one mesh whose map is nearest to that of another.
struct TFit {
  Eigen::MatrixXd control_points;
  /// Largest distance of control points on a mesh that contains both: as all functions are positive and
  /// sum to 1, a bound on the maps' distance anywhere.
  double max_error = 0;
};

/// Least squares over the control points on a common mesh. Exact up to rounding where the map is in the space
/// of `to`; control points whose functions both meshes share stay as they are.
/// @param control_points  of `from`, one column each, any number of rows.
TFit fit(const TMesh& to, const TMesh& from,
         const Eigen::Ref<const Eigen::MatrixXd>& control_points);

}  // namespace crease
