#include "Transforms/Domains/Polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace crease {
namespace {

int next_index(int i, std::size_t size) { return i + 1 == static_cast<int>(size) ? 0 : i + 1; }

int num_edges(std::span<const Point<2>> points, bool closed) {
  const int n = static_cast<int>(points.size());
  return closed ? n : std::max(0, n - 1);
}

/// Marks the points to keep between two kept ones.
void keep_farthest(std::span<const Point<2>> points, int first, int last, double tolerance,
                   std::vector<char>& keep) {
  std::vector<std::pair<int, int>> stack{{first, last}};
  while (!stack.empty()) {
    const auto [a, b] = stack.back();
    stack.pop_back();
    double largest = tolerance;
    int farthest = -1;
    for (int i = a + 1; i < b; ++i) {
      const double d =
          (points[i] - closest_point_on_segment(points[i], points[a], points[b])).norm();
      if (d > largest) {
        largest = d;
        farthest = i;
      }
    }
    if (farthest < 0) continue;
    keep[farthest] = 1;
    stack.emplace_back(a, farthest);
    stack.emplace_back(farthest, b);
  }
}

/// Neighbouring edges meet in their common point; more than that is a fold back.
bool folds_back(const Point<2>& a, const Point<2>& b, const Point<2>& c) {
  const Vector<2> in = b - a, out = c - b;
  return std::abs(cross(in, out)) <= 1e-12 * in.norm() * out.norm() && in.dot(out) < 0;
}

bool on_segment(const Point<2>& p, const Point<2>& a, const Point<2>& b) {
  return (p - closest_point_on_segment(p, a, b)).norm() <= 1e-12 * (b - a).norm();
}

/// Where two edges that share no end meet, collinear overlaps included.
std::optional<Point<2>> contact(const Point<2>& a, const Point<2>& b, const Point<2>& c,
                                const Point<2>& d) {
  if (auto p = segment_crossing(a, b, c, d)) return p;
  for (const auto& p : {c, d}) {
    if (on_segment(p, a, b)) return p;
  }
  for (const auto& p : {a, b}) {
    if (on_segment(p, c, d)) return p;
  }
  return std::nullopt;
}

}  // namespace

double turn_angle(const Vector<2>& a, const Vector<2>& b) {
  return std::atan2(cross(a, b), a.dot(b));
}

double signed_area(std::span<const Point<2>> polygon) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    twice += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  }
  return 0.5 * twice;
}

double polyline_length(std::span<const Point<2>> points, bool closed) {
  double length = 0;
  for (int i = 0; i < num_edges(points, closed); ++i) {
    length += (points[next_index(i, points.size())] - points[i]).norm();
  }
  return length;
}

int winding_number(std::span<const Point<2>> polygon, const Point<2>& p) {
  int winding = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point<2>& a = polygon[i];
    const Point<2>& b = polygon[i + 1 == polygon.size() ? 0 : i + 1];
    if ((a.y() <= p.y()) == (b.y() <= p.y())) continue;
    const double side = cross(b - a, p - a);
    if (b.y() > a.y() && side > 0) ++winding;
    if (b.y() < a.y() && side < 0) --winding;
  }
  return winding;
}

Point<2> closest_point_on_segment(const Point<2>& p, const Point<2>& a, const Point<2>& b) {
  const Vector<2> edge = b - a;
  const double length2 = edge.squaredNorm();
  if (length2 == 0) return a;
  return a + std::clamp((p - a).dot(edge) / length2, 0.0, 1.0) * edge;
}

double distance_to_polyline(std::span<const Point<2>> points, bool closed, const Point<2>& p) {
  double smallest = std::numeric_limits<double>::infinity();
  if (points.size() == 1) return (p - points[0]).norm();
  for (int i = 0; i < num_edges(points, closed); ++i) {
    const auto q = closest_point_on_segment(p, points[i], points[next_index(i, points.size())]);
    smallest = std::min(smallest, (p - q).norm());
  }
  return smallest;
}

std::optional<Point<2>> segment_crossing(const Point<2>& a, const Point<2>& b, const Point<2>& c,
                                         const Point<2>& d) {
  const Vector<2> ab = b - a, cd = d - c;
  const double denominator = cross(ab, cd);
  if (std::abs(denominator) <= 1e-14 * ab.norm() * cd.norm()) return std::nullopt;
  const double s = cross(c - a, cd) / denominator;
  const double t = cross(c - a, ab) / denominator;
  if (s < 0 || s > 1 || t < 0 || t > 1) return std::nullopt;
  return a + s * ab;
}

std::vector<std::pair<int, int>> intersecting_boxes(std::span<const Point<2>> lower,
                                                    std::span<const Point<2>> upper) {
  // Sweep along x; the boxes that are still open are compared along y.
  std::vector<int> order(lower.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int i, int k) { return std::pair(lower[i].x(), i) < std::pair(lower[k].x(), k); });
  std::vector<std::pair<int, int>> pairs;
  std::vector<int> open;
  for (int i : order) {
    std::erase_if(open, [&](int k) { return upper[k].x() < lower[i].x(); });
    for (int k : open) {
      if (lower[k].y() <= upper[i].y() && lower[i].y() <= upper[k].y()) {
        pairs.push_back(std::minmax(i, k));
      }
    }
    open.push_back(i);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::optional<SelfIntersection> find_self_intersection(std::span<const Point<2>> points,
                                                       bool closed) {
  const int n = num_edges(points, closed);
  std::vector<Point<2>> lower, upper;
  for (int i = 0; i < n; ++i) {
    const Point<2>& b = points[next_index(i, points.size())];
    lower.push_back(points[i].cwiseMin(b));
    upper.push_back(points[i].cwiseMax(b));
  }
  for (const auto& [i, k] : intersecting_boxes(lower, upper)) {
    const Point<2>&a = points[i], &b = points[next_index(i, points.size())];
    const Point<2>&c = points[k], &d = points[next_index(k, points.size())];
    if (k == i + 1 && !(closed && n == 2)) {
      if (folds_back(a, b, d)) return SelfIntersection{i, k, b};
    } else if (closed && i == 0 && k == n - 1) {
      if (folds_back(c, a, b)) return SelfIntersection{i, k, a};
    } else if (const auto p = contact(a, b, c, d)) {
      return SelfIntersection{i, k, *p};
    }
  }
  return std::nullopt;
}

Polyline simplify_polyline(std::span<const Point<2>> points, bool closed, double tolerance) {
  if (points.size() < 3) return {points.begin(), points.end()};
  Polyline work(points.begin(), points.end());
  std::vector<char> keep(points.size() + 1, 0);
  if (closed) {
    // Split at the point farthest from the first, both halves end in the first point.
    work.push_back(points[0]);
    int split = 0;
    for (int i = 1; i < static_cast<int>(points.size()); ++i) {
      if ((work[i] - work[0]).squaredNorm() > (work[split] - work[0]).squaredNorm()) split = i;
    }
    keep[0] = keep[split] = 1;
    keep_farthest(work, 0, split, tolerance, keep);
    keep_farthest(work, split, static_cast<int>(points.size()), tolerance, keep);
  } else {
    keep[0] = keep[points.size() - 1] = 1;
    keep_farthest(work, 0, static_cast<int>(points.size()) - 1, tolerance, keep);
  }
  Polyline result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (keep[i]) result.push_back(points[i]);
  }
  return result;
}

Polyline resample_polyline(std::span<const Point<2>> points, bool closed, int count) {
  const int edges = num_edges(points, closed);
  const double step = polyline_length(points, closed) / (closed ? count : count - 1);
  Polyline result{points[0]};
  double passed = 0;
  for (int i = 0; i < edges && static_cast<int>(result.size()) < count; ++i) {
    const Point<2>&a = points[i], &b = points[next_index(i, points.size())];
    const double length = (b - a).norm();
    while (static_cast<int>(result.size()) < count) {
      const double wanted = step * static_cast<double>(result.size());
      if (wanted > passed + length || length == 0) break;
      result.push_back(a + (wanted - passed) / length * (b - a));
    }
    passed += length;
  }
  while (static_cast<int>(result.size()) < count) result.push_back(points.back());
  if (!closed) result.back() = points.back();
  return result;
}

}  // namespace crease
