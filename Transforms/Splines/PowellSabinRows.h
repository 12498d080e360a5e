#pragma once

#include <vector>

#include "Core/Raster.h"
#include "Transforms/Splines/CurvatureGroups.h"
#include "Transforms/Splines/PowellSabinBasis.h"
#include "Transforms/Splines/TriangularBSplineGridKernels.h"

namespace crease {

/// A raster cut into runs of samples that lie in one small triangle, `kind` = 6 times the triangle of the
/// mesh + the small one's number, or outside the domain.
struct PowellSabinRows {
  std::vector<std::vector<GridRun>>
      rows;  ///< runs from left to right; none: no sample in the domain
  std::vector<CurvatureGroups::Group> groups;  ///< of the triangles that hold samples for blocks
};

PowellSabinRows make_powell_sabin_rows(const PowellSabinBasis& basis, const Raster<2>& raster);

}  // namespace crease
