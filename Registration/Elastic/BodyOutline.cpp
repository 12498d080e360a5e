#include "Registration/Elastic/BodyOutline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

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

namespace {

/// A ring of which some corners are left out.
class ThinnedRing {
 public:
  explicit ThinnedRing(const Polyline& ring) : ring_(ring), kept_(ring.size()) {
    std::iota(kept_.begin(), kept_.end(), std::size_t{0});
  }
  std::size_t size() const { return kept_.size(); }
  /// The shorter of the edges at the k-th corner that is left.
  double shorter_edge(std::size_t k) const {
    return std::min((point(k) - point(k + size() - 1)).norm(), (point(k + 1) - point(k)).norm());
  }
  /// How far the edge that is drawn without it runs from it, and from those left out beside it.
  double off_without(std::size_t k) const {
    const std::size_t before = kept_[(k + size() - 1) % size()], after = kept_[(k + 1) % size()];
    double off = 0;
    for (std::size_t i = (before + 1) % ring_.size(); i != after; i = (i + 1) % ring_.size()) {
      const Point<2> nearest = closest_point_on_segment(ring_[i], ring_[before], ring_[after]);
      off = std::max(off, (nearest - ring_[i]).norm());
    }
    return off;
  }
  /// What leaving it out adds to the ring's area, or takes from it.
  double area_without(std::size_t k) const {
    return std::abs(signed_area(Polyline{point(k + size() - 1), point(k), point(k + 1)}));
  }
  void leave_out(std::size_t k) { kept_.erase(kept_.begin() + static_cast<std::ptrdiff_t>(k)); }
  Polyline corners() const {
    Polyline corners;
    for (const std::size_t i : kept_) corners.push_back(ring_[i]);
    return corners;
  }

 private:
  const Point<2>& point(std::size_t k) const { return ring_[kept_[k % size()]]; }

  const Polyline& ring_;
  std::vector<std::size_t> kept_;
};

}  // namespace

Polyline without_short_edges(const Polyline& ring, double shortest, double tolerance) {
  constexpr std::size_t kFewestCorners = 4;
  ThinnedRing thinned(ring);
  while (thinned.size() > kFewestCorners) {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < thinned.size(); ++k) {
      if (thinned.shorter_edge(k) >= shortest) continue;
      const double area = thinned.area_without(k);
      if (area >= least || thinned.off_without(k) > tolerance) continue;
      least = area;
      best = k;
    }
    if (!std::isfinite(least)) break;
    thinned.leave_out(best);
  }
  Polyline result = thinned.corners();
  return find_self_intersection(result, true) ? ring : result;
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
