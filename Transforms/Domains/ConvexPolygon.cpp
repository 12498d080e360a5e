#include "Transforms/Domains/ConvexPolygon.h"

#include <algorithm>

namespace crease {

Polyline clipped_by_line(std::span<const Point<2>> polygon, const Point<2>& a, const Point<2>& b) {
  Polyline result;
  const Vector<2> direction = b - a;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point<2>&p = polygon[i], &q = polygon[i + 1 == polygon.size() ? 0 : i + 1];
    const double sp = cross(direction, p - a), sq = cross(direction, q - a);
    if (sp >= 0) result.push_back(p);
    if ((sp > 0 && sq < 0) || (sp < 0 && sq > 0)) result.push_back(p + sp / (sp - sq) * (q - p));
  }
  return result;
}

Polyline clipped_by_convex(std::span<const Point<2>> polygon, std::span<const Point<2>> convex) {
  Polyline result(polygon.begin(), polygon.end());
  for (std::size_t i = 0; i < convex.size() && !result.empty(); ++i) {
    result = clipped_by_line(result, convex[i], convex[i + 1 == convex.size() ? 0 : i + 1]);
  }
  return result;
}

std::vector<Polyline> convex_difference(std::span<const Point<2>> polygon,
                                        std::span<const Point<2>> convex) {
  std::vector<Polyline> parts;
  Polyline rest(polygon.begin(), polygon.end());
  for (std::size_t i = 0; i < convex.size() && !rest.empty(); ++i) {
    const Point<2>&a = convex[i], &b = convex[i + 1 == convex.size() ? 0 : i + 1];
    Polyline outside = clipped_by_line(rest, b, a);
    if (outside.size() >= 3 && signed_area(outside) > 0) parts.push_back(std::move(outside));
    rest = clipped_by_line(rest, a, b);
  }
  return parts;
}

Polyline convex_hull(std::span<const Point<2>> points) {
  Polyline sorted(points.begin(), points.end());
  std::sort(sorted.begin(), sorted.end(), [](const Point<2>& p, const Point<2>& q) {
    return p.x() < q.x() || (p.x() == q.x() && p.y() < q.y());
  });
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  if (sorted.size() < 3) return sorted;
  Polyline hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t start = hull.size();
    for (const auto& p : sorted) {
      while (hull.size() >= start + 2 &&
             cross(hull.back() - hull[hull.size() - 2], p - hull[hull.size() - 2]) <= 0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(sorted.begin(), sorted.end());
  }
  return hull;
}

}  // namespace crease
