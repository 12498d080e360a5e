#include "Transforms/Splines/PowellSabinTriangles.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "Core/Error.h"
#include "Transforms/Domains/Polygon.h"
#include "Transforms/Splines/PowellSabinCreases.h"

namespace crease {
namespace {

constexpr double kInside = 1e-12;  // of a leg: what counts as on the third side
constexpr double kBetter = 1e-9;   // of an area: smaller by less is rounding

// The angle between the lines of two edges with the polygon in it, in coordinates along its legs.
class Wedge {
 public:
  // @param first, second  edges counter-clockwise one after the other, but perhaps not at once.
  Wedge(std::span<const Point<2>> polygon, std::size_t first, std::size_t second) {
    const Point<2>&p = polygon[first], &q = polygon[second];
    const Vector<2> d = (polygon[(first + 1) % polygon.size()] - p).normalized();
    const Vector<2> e = (polygon[(second + 1) % polygon.size()] - q).normalized();
    opening_ = cross(d, e);
    if (opening_ < 1e-6) return;  // parallel, or open on the polygon's other side
    apex_ = p + cross(q - p, e) / opening_ * d;
    legs_.col(0) = -d;
    legs_.col(1) = e;
    Matrix<2> inverse;
    inverse << -e.y(), e.x(), -d.y(), d.x();
    for (const auto& corner : polygon) points_.emplace_back(inverse / opening_ * (corner - apex_));
  }

  bool closed() const { return !points_.empty(); }
  // Twice the area of the triangle cut off at lengths l of the legs.
  double content(const Vector<2>& l) const { return l.prod() * opening_; }
  // Whether the side from length l[0] of one leg to l[1] of the other has all points on its inner side.
  bool holds(const Vector<2>& l) const {
    if (!(l.minCoeff() > 0) || !l.allFinite()) return false;
    for (const auto& p : points_) {
      if (p[0] / l[0] + p[1] / l[1] > 1 + kInside) return false;
    }
    return true;
  }
  // The legs' lengths where a corner is the third side's midpoint, and where that side runs along an edge.
  Vector<2> touching(std::size_t corner) const { return 2 * points_[corner]; }
  Vector<2> along(std::size_t edge) const {
    const Vector<2>&p = points_[edge], &q = points_[(edge + 1) % points_.size()];
    return Vector<2>(cross(p, q) / (q[1] - p[1]), cross(p, q) / (p[0] - q[0]));
  }
  PowellSabinTriangle triangle(const Vector<2>& l) const {
    return {apex_, apex_ + l[1] * legs_.col(1), apex_ + l[0] * legs_.col(0)};
  }

 private:
  double opening_ = 0;  // sine of the angle
  Point<2> apex_ = Point<2>::Zero();
  Matrix<2> legs_ = Matrix<2>::Zero();
  std::vector<Vector<2>> points_;  // lengths along the legs
};

}  // namespace

PowellSabinTriangle enclosing_triangle(std::span<const Point<2>> polygon) {
  const std::size_t n = polygon.size();
  double least = std::numeric_limits<double>::infinity();
  PowellSabinTriangle best;
  for (std::size_t first = 0; first < n; ++first) {
    for (std::size_t second = 0; second < n; ++second) {
      if (second == first) continue;
      const Wedge wedge(polygon, first, second);
      if (!wedge.closed()) continue;
      const auto attempt = [&](const Vector<2>& lengths) {
        const double content = wedge.content(lengths);
        if (!(content < (1 - kBetter) * least) || !wedge.holds(lengths)) return;
        least = content;
        best = wedge.triangle(lengths);
      };
      for (std::size_t k = 0; k < n; ++k) {
        if (k != first && k != second) attempt(wedge.along(k));
        attempt(wedge.touching(k));
      }
    }
  }
  if (!std::isfinite(least)) {
    throw InvalidInput(message("enclosing_triangle: the polygon of ", n, " corners has no area."));
  }
  return best;
}

PowellSabinVertex triangle_vertex(const PowellSabinTriangle& triangle) {
  PowellSabinVertex vertex;
  vertex.corners.setZero(3, 3);
  for (int j = 0; j < 3; ++j) vertex.corners.col(j).head<2>() = triangle[j];
  return vertex;
}

PowellSabinNet place_powell_sabin(SimplexMesh<2> mesh) {
  DomainMesh domain;
  domain.mesh = std::move(mesh);
  return place_powell_sabin(domain);
}

}  // namespace crease
