#include "Registration/Elastic/BodyOutline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "Core/Error.h"

namespace crease {

std::vector<Point<2>> chest_wall_ends(const RegionOfInterest& body) {
  const Box<2> box = body.bounds();
  const double band = box.size()[0] / 50;
  std::array<double, 2> length{};
  std::array<Polyline, 2> points;
  for (const Polyline& ring : body.rings()) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point<2>&a = ring[i], &b = ring[(i + 1) % ring.size()];
      for (std::size_t side = 0; side < 2; ++side) {
        const double x = side == 0 ? box.lower[0] : box.upper[0];
        if (std::abs(a[0] - x) > band) continue;
        points[side].push_back(a);
        if (std::abs(b[0] - x) <= band) length[side] += (b - a).norm();
      }
    }
  }
  const Polyline& wall = points[length[1] > length[0] ? 1 : 0];
  const auto [first, last] =
      std::ranges::minmax_element(wall, {}, [](const Point<2>& p) { return p[1]; });
  return {*first, *last};
}

Polyline without_short_edges(Polyline ring, double shortest, double tolerance) {
  struct Corner {
    std::size_t place = 0;
    double off = 0;  // from the edge that is drawn without it
  };
  while (ring.size() > 4) {
    std::optional<Corner> least;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point<2>&before = ring[(i + ring.size() - 1) % ring.size()],
            &after = ring[(i + 1) % ring.size()];
      const double shorter = std::min((ring[i] - before).norm(), (after - ring[i]).norm());
      if (shorter >= shortest) continue;
      const double off = (closest_point_on_segment(ring[i], before, after) - ring[i]).norm();
      if (off <= tolerance && (!least || off < least->off)) least = Corner{i, off};
    }
    if (!least) break;
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(least->place));
  }
  return ring;
}

FeatureLine outline_beyond(const Polyline& line, const Box<2>& box, const Point<2>& towards,
                           int label, const std::string& name) {
  if (line.size() < 2) {
    throw InvalidInput(message(name, " has ", line.size(), " point(s); it needs at least two."));
  }
  const double far = 2 * box.size().norm();
  const Point<2> start = line[0] + far * (line[0] - line[1]).normalized();
  const Point<2> end = line.back() + far * (line.back() - line[line.size() - 2]).normalized();
  const Vector<2> across = turned_left(end - start).normalized();
  FeatureLine outline;
  for (const double side : {1.0, -1.0}) {
    outline.points = {start};
    outline.points.insert(outline.points.end(), line.begin(), line.end());
    outline.points.push_back(end);
    outline.points.push_back(0.5 * (start + end) + side * 3 * far * across);
    if (point_in_polygon(outline.points, towards)) break;
  }
  if (signed_area(outline.points) < 0) std::ranges::reverse(outline.points);
  outline.closed = true;
  outline.left_label = label;
  outline.name = name;
  return outline;
}

}  // namespace crease
