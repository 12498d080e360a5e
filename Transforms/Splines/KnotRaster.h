#pragma once

#include <utility>
#include <vector>

#include "Core/Raster.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {

/// A convex region of the plane on the samples of a raster.
class RasterRegion {
 public:
  RasterRegion() = default;
  /// @param sides  normals inwards, mm.
  RasterRegion(std::span<const KnotPlane<2>> sides, const Raster<2>& raster);

  /// Samples first .. last of row j that lie in the region or within `tie` (mm) of it; empty when
  /// first > last.
  std::pair<int, int> samples(int row, double tie) const;

 private:
  struct Side {  // a i + b j + c >= 0, in mm
    double a, b, c;
  };
  std::vector<Side> sides_;
  int width_ = 0;
};

/// A triangle of a basis and its core on a raster.
struct RasterTriangle {
  RasterRegion whole, core;
  int first_row = 0, last_row = -1;  ///< that the triangle may reach
  double control_spacing = 0;        ///< of its control points, about, in samples
};

std::vector<RasterTriangle> triangles_on_raster(const TriangularBSplineBasis<2>& basis,
                                                const Raster<2>& raster);

}  // namespace crease
