#include "Transforms/Splines/KnotCells.h"

#include <algorithm>
#include <cmath>

#include "Transforms/Splines/KnotLocator.h"

namespace crease {
namespace {

// Part [lower, upper] of the line start + s direction inside a convex polygon; empty when lower > upper.
struct Range {
  double lower, upper;
};

Range part_inside(const KnotPolygon& polygon, const Point<2>& start, const Vector<2>& direction,
                  double lower, double upper, double tie) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point<2>&p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const Vector<2> edge = q - p;
    const double length = edge.norm();
    if (length == 0.0) continue;
    const double height = cross(edge, start - p) / length;  // >= 0 inside
    const double slope = cross(edge, direction) / length;
    if (std::abs(slope) < 1e-14) {
      if (height < -tie) return {1.0, 0.0};
    } else if (slope > 0.0) {
      lower = std::max(lower, -height / slope);
    } else {
      upper = std::min(upper, -height / slope);
    }
  }
  return {lower, upper};
}

// Cuts a convex polygon by a line; corners within the tie count as on it.
void split(const KnotPolygon& polygon, const std::vector<double>& heights, double tie,
           KnotPolygon& left, KnotPolygon& right) {
  const std::size_t count = polygon.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = (i + 1) % count;
    const double hi = heights[i], hk = heights[k];
    if (hi >= -tie) left.push_back(polygon[i]);
    if (hi <= tie) right.push_back(polygon[i]);
    if ((hi > tie && hk < -tie) || (hi < -tie && hk > tie)) {
      const Point<2> x = polygon[i] + hi / (hi - hk) * (polygon[k] - polygon[i]);
      left.push_back(x);
      right.push_back(x);
    }
  }
}

}  // namespace

KnotCells::KnotCells(const KnotNet<2>& net)
    : net_(net),
      tie_(kKnotTie * mesh_scale(net.mesh)),
      neighbours_(vertex_neighbours(net.mesh)),
      bands_(net) {}

void KnotCells::add_segment(const Point<2>& a, const Point<2>& b, const KnotPolygon& triangle,
                            std::vector<Segment>& segments) const {
  Segment s{a, b - a, (b - a).norm()};
  if (s.length <= tie_) return;
  s.direction /= s.length;
  const Range inside = part_inside(triangle, s.start, s.direction, 0.0, s.length, tie_);
  if (inside.upper - inside.lower > tie_) segments.push_back(s);
}

std::vector<KnotCells::Segment> KnotCells::segments_in(int triangle,
                                                       const KnotPolygon& corners) const {
  std::vector<std::pair<int, int>> edges;  // a vertex twice: its own cloud
  for (int t : neighbours_[triangle]) {
    const auto& v = net_.mesh.simplices[t];
    for (int j = 0; j < 3; ++j) {
      edges.emplace_back(v[j], v[j]);
      edges.emplace_back(std::minmax(v[j], v[(j + 1) % 3]));
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());

  std::vector<Segment> segments;
  for (const auto& [a, b] : edges) {
    const auto &first = net_.clouds[a], &second = net_.clouds[b];
    for (int i = 0; i < static_cast<int>(first.size()); ++i) {
      const int start = a == b ? i + 1 : 0;
      const int end = a == b ? static_cast<int>(second.size())
                             : std::min(static_cast<int>(second.size()), net_.degree - i + 1);
      for (int j = start; j < end; ++j) add_segment(first[i], second[j], corners, segments);
    }
  }
  for (int b : bands_.bands_in(triangle)) {
    const auto& hull = bands_.bands()[b].hull;
    for (std::size_t i = 0; i < hull.size(); ++i) {
      add_segment(hull[i], hull[(i + 1) % hull.size()], corners, segments);
    }
  }
  std::stable_sort(segments.begin(), segments.end(),
                   [](const Segment& s, const Segment& t) { return s.length > t.length; });
  return segments;
}

void KnotCells::cut(std::vector<KnotPolygon>& polygons, const Segment& segment) const {
  const Vector<2> normal = turned_left(segment.direction);
  const double offset = normal.dot(segment.start);
  std::vector<double> heights;
  const std::size_t count = polygons.size();
  for (std::size_t i = 0; i < count; ++i) {
    double lowest = 0.0, highest = 0.0;
    heights.clear();
    for (const auto& p : polygons[i]) {
      heights.push_back(normal.dot(p) - offset);
      lowest = std::min(lowest, heights.back());
      highest = std::max(highest, heights.back());
    }
    if (lowest >= -tie_ || highest <= tie_) continue;
    const Range inside =
        part_inside(polygons[i], segment.start, segment.direction, 0.0, segment.length, tie_);
    if (inside.upper - inside.lower <= tie_) continue;
    KnotPolygon left, right;
    left.reserve(polygons[i].size() + 1);
    right.reserve(polygons[i].size() + 1);
    split(polygons[i], heights, tie_, left, right);
    polygons[i] = std::move(left);
    polygons.push_back(std::move(right));
  }
}

std::vector<KnotCell> KnotCells::of_triangle(int triangle) const {
  const auto corners = simplex_corners(net_.mesh, triangle);
  const KnotPolygon whole(corners.begin(), corners.end());
  std::vector<KnotPolygon> polygons = {whole};
  for (const Segment& segment : segments_in(triangle, whole)) cut(polygons, segment);

  std::vector<KnotCell> cells;
  cells.reserve(polygons.size());
  for (auto& polygon : polygons) {
    const PolygonMoments moments = polygon_moments(polygon);
    if (!(moments.area > 0.0)) continue;
    cells.push_back({std::move(polygon), moments.centroid, moments.area,
                     bands_.contains(triangle, moments.centroid),
                     bands_.contains_two_sided(triangle, moments.centroid)});
  }
  return cells;
}

}  // namespace crease
