#pragma once

#include "Images/DisplacedInterpolator.h"
#include "Transforms/BoundGrid.h"
#include "Transforms/SplineTransform.h"

namespace crease {

/// A spline's displacement in a form that is cheap to read at any point near its domain.
struct DisplacementSamples {
  DisplacedInterpolator<2>::Components components;  ///< of T(y) - y, mm
  int step = 1;                                     ///< pixels of the grid from node to node
  double largest_error = 0;  ///< against T at the grid's samples in the domain, in pixels
};

/// How near and how far.
struct DisplacementSamplesOptions {
  double margin_mm = 4;     ///< beyond the domain up to which T's own continuation is followed
  double tolerance = 0.01;  ///< pixels
};

/// Interpolates T(y) - y by cubic B-splines through nodes every 4, 2 or 1 pixels of a bound grid: the widest
/// step whose error at all samples in the domain is within the tolerance, else 1, which is exact there.
/// Between the samples the error is of fourth order where T is smooth; across a crease it is a tenth of the
/// step times the jump of the slope at most.
///
/// Outside the domain T continues from its border's nearest point (SplineTransform); farther than the margin
/// the displacement stays as it is there.
/// @param grid  of T's basis.
DisplacementSamples sample_displacement(const SplineTransform<2>& transform,
                                        const BoundGrid<2>& grid,
                                        const DisplacementSamplesOptions& options = {});

}  // namespace crease
