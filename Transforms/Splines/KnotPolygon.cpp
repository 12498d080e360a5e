#include "Transforms/Splines/KnotPolygon.h"

namespace crease {
KnotPlane<2> side_through(const Point<2>& a, const Point<2>& b) {
  const Vector<2> d = (b - a).normalized();
  const Vector<2> normal(-d[1], d[0]);
  return {normal, normal.dot(a)};
}

PolygonMoments polygon_moments(std::span<const Point<2>> polygon) {
  PolygonMoments m;
  Vector<2> first = Vector<2>::Zero();
  Matrix<2> second = Matrix<2>::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Vector<2> p = polygon[i - 1] - polygon[0], q = polygon[i] - polygon[0];
    const double area = 0.5 * cross(p, q);
    m.area += area;
    first += area / 3.0 * (p + q);
    const Vector<2> sum = p + q;
    second += area / 12.0 * (p * p.transpose() + q * q.transpose() + sum * sum.transpose());
  }
  if (m.area > 0.0) {
    const Vector<2> centre = first / m.area;
    m.centroid = polygon[0] + centre;
    m.covariance = second / m.area - centre * centre.transpose();
  }
  return m;
}

KnotPolygon clip(const KnotPolygon& polygon, const KnotPlane<2>& side) {
  KnotPolygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point<2>&p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double hp = side.distance(p), hq = side.distance(q);
    if (hp >= 0.0) kept.push_back(p);
    if ((hp > 0.0 && hq < 0.0) || (hp < 0.0 && hq > 0.0)) {
      kept.push_back(p + hp / (hp - hq) * (q - p));
    }
  }
  return kept.size() < 3 ? KnotPolygon{} : kept;
}

bool polygon_contains(const KnotPolygon& polygon, const Point<2>& u, double tie) {
  if (polygon.size() < 3) return false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto side = side_through(polygon[i], polygon[(i + 1) % polygon.size()]);
    if (side.distance(u) < -tie) return false;
  }
  return true;
}

}  // namespace crease
