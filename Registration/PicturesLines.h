#pragma once

#include <vector>

#include "Images/Resample.h"
#include "Registration/Pictures.h"
#include "Registration/PicturesSlices.h"
#include "Transforms/Domains/FeatureLine.h"

namespace crease {

/// A slice as a ground for lines: grey from the 1 % to the 99 % percentile of the image, a little dimmed.
template <int Dim>
Picture dimmed_panel(const Image<float, Dim>& image, const Slice<Dim>& slice);

/// Lines of constant index along both axes of the slice, in mm: about `count` along the raster's longer
/// side, from edge to edge. @param depth  the index along the third axis (3D).
template <int Dim>
std::vector<std::vector<Point<Dim>>> grid_lines(const Raster<Dim>& raster, const Slice<Dim>& slice,
                                                int count, double depth);

/// A polyline mapped by T into the picture of a slice of the moving image, in pixels: in pieces of about
/// `step` pixels, broken where the map has no value.
template <int Dim>
std::vector<std::vector<Point<2>>> mapped_line(const Slice<Dim>& slice, const Raster<Dim>& moving,
                                               const PointMap<Dim>& map,
                                               const std::vector<Point<Dim>>& line,
                                               double step = 4);

/// A line's points, the first repeated at the end of a closed one.
Polyline closed_points(const FeatureLine& line);

extern template Picture dimmed_panel<2>(const Image<float, 2>&, const Slice<2>&);
extern template Picture dimmed_panel<3>(const Image<float, 3>&, const Slice<3>&);
extern template std::vector<std::vector<Point<2>>> grid_lines<2>(const Raster<2>&, const Slice<2>&,
                                                                 int, double);
extern template std::vector<std::vector<Point<3>>> grid_lines<3>(const Raster<3>&, const Slice<3>&,
                                                                 int, double);
extern template std::vector<std::vector<Point<2>>> mapped_line<2>(const Slice<2>&, const Raster<2>&,
                                                                  const PointMap<2>&,
                                                                  const std::vector<Point<2>>&,
                                                                  double);
extern template std::vector<std::vector<Point<2>>> mapped_line<3>(const Slice<3>&, const Raster<3>&,
                                                                  const PointMap<3>&,
                                                                  const std::vector<Point<3>>&,
                                                                  double);

}  // namespace crease
