#include "Transforms/Splines/KnotRaster.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/KnotPolygon.h"

namespace crease {

RasterRegion::RasterRegion(std::span<const KnotPlane<2>> sides, const Raster<2>& raster)
    : width_(raster.size[0]) {
  const Matrix<2> step = raster.index_to_point();
  for (const auto& side : sides) {
    Side s{side.normal.dot(step.col(0)), side.normal.dot(step.col(1)),
           side.distance(raster.origin)};
    if (std::abs(s.a) < 1e-14 * raster.spacing[0]) s.a = 0.0;
    sides_.push_back(s);
  }
}

std::pair<int, int> RasterRegion::samples(int row, double tie) const {
  double lower = 0.0, upper = width_ - 1.0;
  for (const auto& [a, b, c] : sides_) {
    const double rest = b * row + c + tie;
    if (a > 0.0) {
      lower = std::max(lower, -rest / a);
    } else if (a < 0.0) {
      upper = std::min(upper, rest / -a);
    } else if (rest < 0.0) {
      return {0, -1};
    }
  }
  if (!(lower <= upper)) return {0, -1};
  return {static_cast<int>(std::ceil(lower)), static_cast<int>(std::floor(upper))};
}

std::vector<RasterTriangle> triangles_on_raster(const TriangularBSplineBasis<2>& basis,
                                                const Raster<2>& raster) {
  const auto& mesh = basis.net().mesh;
  std::vector<RasterTriangle> triangles(mesh.simplices.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto corners = simplex_corners(mesh, static_cast<int>(t));
    std::vector<KnotPlane<2>> sides;
    double low = std::numeric_limits<double>::infinity(), high = -low, longest = 0.0;
    for (int k = 0; k < 3; ++k) {
      const Point<2> a = raster.index(corners[k]), b = raster.index(corners[(k + 1) % 3]);
      longest = std::max(longest, (b - a).norm());
      sides.push_back(side_through(corners[k], corners[(k + 1) % 3]));
      const double j = raster.index(corners[k])[1];
      low = std::min(low, j);
      high = std::max(high, j);
    }
    const double last = raster.size[1] - 1.0;
    const double twice_area = signed_content<2>(corners) / raster.sample_volume();
    const double altitude = longest > 0.0 ? twice_area / longest : 0.0;  // on the longest side
    triangles[t] = {RasterRegion(sides, raster),
                    RasterRegion(basis.patch(static_cast<int>(t)).core_sides(), raster),
                    static_cast<int>(std::clamp(std::floor(low), 0.0, last + 1.0)),
                    static_cast<int>(std::clamp(std::ceil(high), -1.0, last)),
                    altitude / basis.degree()};
  }
  return triangles;
}

}  // namespace crease
