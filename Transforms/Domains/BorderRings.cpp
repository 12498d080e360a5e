#include "Transforms/Domains/BorderRings.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "Core/Error.h"
#include "Transforms/Domains/ArcLength.h"
#include "Transforms/Domains/CurveSampling.h"

namespace crease {
namespace {

std::optional<Point<2>> nearest_on_border(const RegionOfInterest& region, const Point<2>& p,
                                          double distance) {
  std::optional<Point<2>> nearest;
  for (const auto& ring : region.rings()) {
    const NearestPlace place = nearest_place(ring, true, p);
    if (place.distance > distance) continue;
    distance = place.distance;
    nearest = place.point;
  }
  return nearest;
}

std::optional<Point<2>> corner_near(const RegionOfInterest& region, const Point<2>& p,
                                    double distance) {
  constexpr double kCorner = 0.1;  // radians
  std::optional<Point<2>> nearest;
  for (const auto& ring : region.rings()) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vector<2> in = ring[k] - ring[(k + ring.size() - 1) % ring.size()];
      const Vector<2> out = ring[(k + 1) % ring.size()] - ring[k];
      if (std::abs(turn_angle(in, out)) <= kCorner || (ring[k] - p).norm() > distance) continue;
      distance = (ring[k] - p).norm();
      nearest = ring[k];
    }
  }
  return nearest;
}

/// A ring with the meetings put in, and their positions.
struct MarkedRing {
  Polyline points;
  std::vector<std::size_t> marks;
};

MarkedRing marked(const Polyline& ring, const std::vector<Point<2>>& meetings, double tolerance) {
  MarkedRing result;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Point<2>&a = ring[k], &b = ring[(k + 1) % ring.size()];
    result.points.push_back(a);
    std::vector<std::pair<double, Point<2>>> on_edge;
    for (const auto& p : meetings) {
      const bool on = (p - closest_point_on_segment(p, a, b)).norm() <= tolerance;
      if (on && (p - b).norm() > tolerance) on_edge.emplace_back((p - a).norm(), p);
    }
    std::sort(on_edge.begin(), on_edge.end(),
              [](const auto& p, const auto& q) { return p.first < q.first; });
    for (const auto& [distance, p] : on_edge) {
      if (distance > tolerance) result.points.push_back(p);
      result.marks.push_back(result.points.size() - 1);
      result.points.back() = p;
    }
  }
  return result;
}

Polyline sampled_ring(MarkedRing ring, const LineArrangementOptions& options, bool keep_points) {
  constexpr int kFewestEdges = 10;  // of a small hole
  const double longest = polyline_length(ring.points, true) / kFewestEdges;
  const auto length = [&](const Point<2>& p) {
    return std::min(options.border_length(p), longest);
  };
  const bool keep = keep_points || !is_dense(ring.points, true, length);
  const CurveSamplingOptions sampling{.tolerance = keep ? 0 : options.tolerance,
                                      .smallest_edge = keep ? 0 : 0.4};
  if (ring.marks.empty()) {
    return sample_curve(ring.points, true, length, sampling).points;
  }
  const auto first = static_cast<std::ptrdiff_t>(ring.marks[0]);
  std::rotate(ring.points.begin(), ring.points.begin() + first, ring.points.end());
  ring.points.push_back(ring.points.front());
  Polyline result;
  for (std::size_t m = 0; m < ring.marks.size(); ++m) {
    const std::size_t from = ring.marks[m] - ring.marks[0];
    const std::size_t to =
        m + 1 < ring.marks.size() ? ring.marks[m + 1] - ring.marks[0] : ring.points.size() - 1;
    const auto stretch = std::span(ring.points).subspan(from, to - from + 1);
    const auto part = sample_curve(stretch, false, length, sampling).points;
    result.insert(result.end(), part.begin(), part.end() - 1);
  }
  return result;
}

}  // namespace

BorderMeetings attach_to_border(const RegionOfInterest& region, std::vector<FeatureLine>& lines,
                                double near, double tolerance) {
  BorderMeetings meetings;
  for (auto& line : lines) {
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      Point<2>& p = line.points[i];
      const bool is_end = !line.closed && (i == 0 || i + 1 == line.points.size());
      auto target = nearest_on_border(region, p, is_end ? near : tolerance);
      if (!target) continue;
      const auto known = std::find_if(meetings.points.begin(), meetings.points.end(),
                                      [&](const auto& q) { return (q - *target).norm() <= near; });
      if (known != meetings.points.end()) {
        target = *known;
      } else {
        if (const auto corner = corner_near(region, *target, near)) target = corner;
        meetings.points.push_back(*target);
      }
      if ((*target - p).norm() > tolerance) {
        ++meetings.num_moved;
        meetings.largest_shift = std::max(meetings.largest_shift, (*target - p).norm());
      }
      p = *target;
    }
  }
  return meetings;
}

std::vector<Polyline> sampled_border(const RegionOfInterest& region,
                                     const std::vector<Point<2>>& meetings,
                                     const LineArrangementOptions& options, double tolerance) {
  const auto sampled = [&](bool keep_points) {
    std::vector<Polyline> rings;
    for (const auto& ring : region.rings()) {
      rings.push_back(sampled_ring(marked(ring, meetings, tolerance), options, keep_points));
    }
    return RegionOfInterest(std::move(rings)).rings();
  };
  try {
    return sampled(false);
  } catch (const InvalidInput&) {  // narrow parts need all their points
    return sampled(true);
  }
}

}  // namespace crease
