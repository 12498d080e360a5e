#pragma once

#include <functional>

#include "Transforms/Splines/TSplineBasis.h"

namespace crease {

/// A basis and the control points of the same map as before.
struct TSplineRefinement {
  std::shared_ptr<const TSplineBasis> basis;
  Eigen::MatrixXd control_points;  ///< as many rows as before, one column per control point
};

/// Halves faces of the mesh along both axes: those that hold the Bezier elements given. Further edges keep the
/// mesh analysis-suitable and the old space within the new one (`nested`); the map stays the same up to rounding.
/// @param control_points  one column per control point, any number of rows.
/// @throws InvalidInput when the sizes do not fit or there is no such element.
TSplineRefinement refined(const TSplineBasis& basis,
                          const Eigen::Ref<const Eigen::MatrixXd>& control_points,
                          const std::vector<int>& elements);

/// The same for all elements on which the functions of some control points do not vanish.
TSplineRefinement refined_around(const TSplineBasis& basis,
                                 const Eigen::Ref<const Eigen::MatrixXd>& control_points,
                                 const std::vector<int>& control_point_numbers);

/// Adds edges to the mesh, at knots of its own or new ones.
/// @param edges  each along an axis at a knot of the other one, from knot to knot, mm along the axes; they are
///               led on to the next edges.
struct TEdge {
  int axis = 0;
  double knot = 0;
  double begin = 0;
  double end = 0;
};
TSplineRefinement with_edges(const TSplineBasis& basis,
                             const Eigen::Ref<const Eigen::MatrixXd>& control_points,
                             const std::vector<TEdge>& edges);

/// The edge length, mm, that a point of the domain asks for; infinity where it does not care.
using EdgeLengthField = std::function<double(const Point<2>&)>;

/// A T-spline whose domain is exactly the pixels of a raster (half a pixel beyond the outer centres),
/// along its axes: faces as near to `length_mm` as fits, halved along an axis as long as they are more than
/// sqrt(2) times as long as one of their pixels (its centre) asks.
/// @param finer_at  asked once per pixel; null: the same faces everywhere.
/// @param degree    1, 3 or 5.
/// @throws InvalidInput when the raster is empty, a length is not positive, or the faces would be too many.
std::shared_ptr<const TSplineBasis> covering_tspline(const Raster<2>& raster, double length_mm,
                                                     const EdgeLengthField& finer_at = nullptr,
                                                     int degree = 3);

}  // namespace crease
