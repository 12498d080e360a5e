#include "Transforms/Domains/ArcLength.h"

#include <algorithm>

namespace crease {

std::vector<double> arc_lengths(std::span<const Point<2>> points) {
  std::vector<double> lengths(points.size(), 0.0);
  for (std::size_t i = 1; i < points.size(); ++i) {
    lengths[i] = lengths[i - 1] + (points[i] - points[i - 1]).norm();
  }
  return lengths;
}

PlaceBetween place_at_length(std::span<const double> lengths, double length) {
  const auto above = std::upper_bound(lengths.begin(), lengths.end(), length) - lengths.begin();
  const auto next =
      static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above, 1, std::ssize(lengths) - 1));
  const double before = lengths[next - 1], step = lengths[next] - before;
  return {next - 1, step > 0 ? std::clamp((length - before) / step, 0.0, 1.0) : 0.0};
}

Point<2> point_at_length(std::span<const Point<2>> points, std::span<const double> lengths,
                         double length) {
  const auto [first, share] = place_at_length(lengths, length);
  return points[first] + share * (points[first + 1] - points[first]);
}

NearestPlace nearest_place(std::span<const Point<2>> points, bool closed, const Point<2>& p) {
  NearestPlace nearest;
  double length = 0;
  const std::size_t edges = points.size() - (closed || points.empty() ? 0 : 1);
  for (std::size_t i = 0; i < edges; ++i) {
    const Point<2>&a = points[i], &b = points[i + 1 == points.size() ? 0 : i + 1];
    const Point<2> q = closest_point_on_segment(p, a, b);
    if (const double distance = (p - q).norm(); distance < nearest.distance) {
      nearest = {distance, length + (q - a).norm(), q};
    }
    length += (b - a).norm();
  }
  return nearest;
}

}  // namespace crease
