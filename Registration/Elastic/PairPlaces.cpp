#include "Registration/Elastic/PairPlaces.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "Core/Error.h"
#include "Core/Quantiles.h"
#include "Registration/Elastic/PairText.h"
#include "Registration/Elastic/SnapWarnings.h"
#include "Transforms/Domains/ArcLength.h"

namespace crease {
namespace {

constexpr std::size_t kNeighbours = 5;

std::string name_of(const Landmarks<2>& pairs, std::size_t i) {
  const bool named = i < pairs.names.size() && !pairs.names[i].empty();
  return named ? message("pair ", i + 1, " (", pairs.names[i], ")") : message("pair ", i + 1);
}

Point<2> nearest_on_rings(const RegionOfInterest& region, const Point<2>& p) {
  NearestPlace nearest{.point = p};
  for (const Polyline& ring : region.rings()) {
    const NearestPlace place = nearest_place(ring, true, p);
    if (place.distance < nearest.distance) nearest = place;
  }
  return nearest.point;
}

/// The pairs whose fixed points are nearest to that of pair i.
std::vector<std::size_t> neighbours_of(const Landmarks<2>& pairs, std::size_t i) {
  std::vector<std::size_t> others(pairs.fixed.size());
  std::iota(others.begin(), others.end(), 0);
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
  std::ranges::sort(others, {}, [&](std::size_t k) {
    return std::pair((pairs.fixed[k] - pairs.fixed[i]).norm(), k);
  });
  others.resize(std::min(others.size(), kNeighbours));
  return others;
}

/// A pair that lies on one of those found.
struct NearPair {
  std::size_t pair;
  double distance;  // mm
  const char* image;
};

std::optional<NearPair> other_pair_at(const Landmarks<2>& pairs, std::size_t c,
                                      const std::vector<char>& is_found, double near_mm) {
  for (std::size_t i = 0; i < pairs.fixed.size(); ++i) {
    if (is_found[i]) continue;
    const double fixed = (pairs.fixed[i] - pairs.fixed[c]).norm();
    const double moving = (pairs.moving[i] - pairs.moving[c]).norm();
    if (fixed <= near_mm) return NearPair{i, fixed, "fixed"};
    if (moving <= near_mm) return NearPair{i, moving, "moving"};
  }
  return std::nullopt;
}

/// Drops what is marked; a list that is shorter than the marks has no entries there.
template <typename Entry>
void erase_marked(std::vector<Entry>& list, const std::vector<char>& marked) {
  std::vector<Entry> kept;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!marked[i]) kept.push_back(std::move(list[i]));
  }
  list = std::move(kept);
}

/// Drops the numbers that are marked, and counts the others without them.
void renumber(std::vector<int>& numbers, const std::vector<char>& marked) {
  std::vector<int> kept;
  for (int number : numbers) {
    if (marked[static_cast<std::size_t>(number)]) continue;
    kept.push_back(number -
                   static_cast<int>(std::count(marked.begin(), marked.begin() + number, 1)));
  }
  numbers = std::move(kept);
}

}  // namespace

void place_on_border(Landmarks<2>& pairs, const std::vector<int>& contour,
                     const SplineBasis<2>& basis, double tolerance_mm) {
  for (const int number : contour) {
    const auto i = static_cast<std::size_t>(number);
    if (basis.contains(pairs.fixed[i])) continue;
    const Point<2> border = basis.nearest_point(pairs.fixed[i]);
    const Vector<2> shift = border - pairs.fixed[i];
    if (shift.norm() > tolerance_mm) continue;
    pairs.fixed[i] = border;
    pairs.moving[i] += shift;
  }
}

std::vector<std::string> snap_moving_points(Landmarks<2>& pairs, const RegionOfInterest& body,
                                            const std::string& name, double snap_mm) {
  constexpr double kOnBorder = 1e-9;  // mm
  SnapWarnings warnings("moving points", name);
  for (std::size_t i = 0; i < pairs.moving.size(); ++i) {
    Point<2>& q = pairs.moving[i];
    if (body.contains(q)) continue;
    const Point<2> border = nearest_on_rings(body, q);
    const double distance = (border - q).norm();
    if (distance < kOnBorder) continue;
    const std::string point = message(name_of(pairs, i), ": the moving point ", place_text(q));
    if (distance > snap_mm) {
      throw InvalidInput(message(point, " lies ", fixed_text(distance), " mm outside ", name,
                                 "; correct it or leave the pair out."));
    }
    warnings.add(point, distance);
    q = border;
  }
  return warnings.list();
}

std::vector<std::string> leave_out_found_pairs(Landmarks<2>& pairs, std::vector<int>& found,
                                               double near_mm) {
  std::vector<std::string> warnings;
  std::vector<char> is_found(pairs.fixed.size(), 0), left_out(pairs.fixed.size(), 0);
  for (int c : found) is_found[static_cast<std::size_t>(c)] = 1;
  for (int number : found) {
    const auto c = static_cast<std::size_t>(number);
    const auto at = other_pair_at(pairs, c, is_found, near_mm);
    if (!at) continue;
    left_out[c] = 1;
    warnings.push_back(message(name_of(pairs, at->pair), " lies ", fixed_text(at->distance),
                               " mm from ", name_of(pairs, c), " in the ", at->image,
                               " image; the latter, found in the images, was left out."));
  }
  renumber(found, left_out);
  erase_marked(pairs.fixed, left_out);
  erase_marked(pairs.moving, left_out);
  erase_marked(pairs.names, left_out);
  erase_marked(pairs.sigma_mm, left_out);
  erase_marked(pairs.fixed_angle, left_out);
  erase_marked(pairs.moving_angle, left_out);
  return warnings;
}

std::vector<std::string> strange_pairs(const Landmarks<2>& pairs, double width_mm, double share) {
  std::vector<std::string> warnings;
  if (pairs.size() < 4) return warnings;
  for (std::size_t i = 0; i < pairs.fixed.size(); ++i) {
    const auto others = neighbours_of(pairs, i);
    Vector<2> usual;
    for (int a = 0; a < 2; ++a) {
      std::vector<double> moved;
      for (std::size_t k : others) moved.push_back((pairs.moving[k] - pairs.fixed[k])[a]);
      usual[a] = median(std::move(moved));
    }
    const double unlike = (pairs.moving[i] - pairs.fixed[i] - usual).norm();
    if (unlike <= share * width_mm) continue;
    warnings.push_back(message(name_of(pairs, i), " at ", place_text(pairs.fixed[i]), " moves ",
                               fixed_text(unlike), " mm unlike its neighbours; it may be wrong."));
  }
  return warnings;
}

}  // namespace crease
