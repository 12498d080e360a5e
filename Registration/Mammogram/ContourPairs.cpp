#include "Registration/Mammogram/ContourPairs.h"

#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Transforms/Domains/ArcLength.h"

namespace crease {
namespace {

/// A contour as a function of the share t of its length.
class ContourByShare {
 public:
  explicit ContourByShare(const Polyline& points)
      : points_(points), lengths_(arc_lengths(points)) {}
  double length() const { return lengths_.back(); }
  Point<2> at(double t) const { return point_at_length(points_, lengths_, t * length()); }
  /// Where the contour is nearest to a point.
  double nearest(const Point<2>& p) const {
    return nearest_place(points_, false, p).length / length();
  }

 private:
  const Polyline& points_;
  std::vector<double> lengths_;
};

void check(const Polyline& fixed, const Polyline& moving, const ContourPairOptions& options) {
  if (options.count < 3) throw InvalidInput("contour pairs: at least 3 are needed.");
  for (const auto& [contour, name] : {std::pair(&fixed, "fixed"), std::pair(&moving, "moving")}) {
    if (contour->size() < 2 || !(polyline_length(*contour, false) > 0)) {
      throw InvalidInput(message("contour pairs: the contour of the ", name, " image is empty."));
    }
  }
  if (!options.stretch) return;
  constexpr double kRounding = 1e-9;
  const double first = options.stretch(0), end = options.stretch(1);
  bool good = std::abs(first) <= kRounding && std::abs(end - 1) <= kRounding;
  double last = -1;
  for (int k = 0; k < options.count; ++k) {
    const double h = options.stretch(k / double(options.count - 1));
    good = good && h > last && h >= -kRounding && h <= 1 + kRounding;
    last = h;
  }
  if (!good) throw InvalidInput("contour pairs: the stretch must grow from 0 to 1.");
}

/// Shares of the two contours that correspond.
struct SharePair {
  double fixed = 0, moving = 0;
};

}  // namespace

ContourPairs contour_pairs(const Polyline& fixed, const Polyline& moving,
                           const std::optional<Point<2>>& fixed_nipple,
                           const std::optional<Point<2>>& moving_nipple,
                           const ContourPairOptions& options) {
  check(fixed, moving, options);
  const ContourByShare on_fixed(fixed), on_moving(moving);
  ContourPairs pairs;
  pairs.fixed_length_mm = on_fixed.length();
  pairs.moving_length_mm = on_moving.length();
  const int last = options.count - 1;
  int split = 0;  // the nipple's pair; 0: none
  SharePair nipple;
  if (options.use_nipples && fixed_nipple && moving_nipple && !options.stretch) {
    nipple = {on_fixed.nearest(*fixed_nipple), on_moving.nearest(*moving_nipple)};
    const double share = 0.5 * (nipple.fixed + nipple.moving);
    const bool inside =
        std::min(nipple.fixed, nipple.moving) > 0 && std::max(nipple.fixed, nipple.moving) < 1;
    if (inside) split = std::clamp(static_cast<int>(std::lround(share * last)), 1, last - 1);
  }
  pairs.nipple_used = split > 0;
  for (int k = 0; k <= last; ++k) {
    SharePair t = {k / double(last), k / double(last)};
    if (options.stretch) {
      t.moving = std::clamp(options.stretch(t.fixed), 0.0, 1.0);
    } else if (split > 0 && k <= split) {
      const double share = k / double(split);
      t = {share * nipple.fixed, share * nipple.moving};
    } else if (split > 0) {
      const double share = (k - split) / double(last - split);
      t = {nipple.fixed + share * (1 - nipple.fixed), nipple.moving + share * (1 - nipple.moving)};
    }
    pairs.landmarks.fixed.push_back(on_fixed.at(t.fixed));
    pairs.landmarks.moving.push_back(on_moving.at(t.moving));
    pairs.landmarks.names.push_back(split > 0 && k == split ? "nipple"
                                                            : message("contour ", k + 1));
  }
  return pairs;
}

ContourPairs contour_pairs(const MammogramAnatomy& fixed, const MammogramAnatomy& moving,
                           const ContourPairOptions& options) {
  const auto nipple = [](const MammogramAnatomy& anatomy) -> std::optional<Point<2>> {
    if (!anatomy.skin.nipple) return std::nullopt;
    return anatomy.skin.nipple->point;
  };
  return contour_pairs(fixed.contour_below_pectoral(), moving.contour_below_pectoral(),
                       nipple(fixed), nipple(moving), options);
}

}  // namespace crease
