#include "Registration/Mammogram/PectoralPairs.h"

#include <algorithm>

#include "Core/Error.h"
#include "Transforms/Domains/ArcLength.h"

namespace crease {
namespace {

constexpr double kFarthestFromSkin = 3;  // mm

bool begins_at_the_skin(const MammogramAnatomy& anatomy) {
  return anatomy.pectoral &&
         distance_to_polyline(anatomy.skin.points, false, anatomy.pectoral->line.front()) <=
             kFarthestFromSkin;
}

}  // namespace

Landmarks<2> pectoral_pairs(const Polyline& fixed, const Polyline& moving, int count) {
  Landmarks<2> pairs;
  if (fixed.size() < 2 || moving.size() < 2) return pairs;
  const std::vector<double> on_fixed = arc_lengths(fixed), on_moving = arc_lengths(moving);
  const double shorter = std::min(on_fixed.back(), on_moving.back());
  for (int k = 1; k <= count; ++k) {
    const double length = shorter * k / (count + 0.5);
    pairs.fixed.push_back(point_at_length(fixed, on_fixed, length));
    pairs.moving.push_back(point_at_length(moving, on_moving, length));
    pairs.names.push_back(message("pectoral ", k));
  }
  return pairs;
}

Landmarks<2> pectoral_pairs(const MammogramAnatomy& fixed, const MammogramAnatomy& moving,
                            int count) {
  if (!begins_at_the_skin(fixed) || !begins_at_the_skin(moving)) return {};
  return pectoral_pairs(fixed.pectoral->line, moving.pectoral->line, count);
}

}  // namespace crease
