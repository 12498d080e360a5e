#include "Registration/Mammogram/ContourPairs.h"

#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Transforms/Domains/ArcLength.h"

namespace crease {
namespace {

constexpr double kRounding = 1e-9;  // of shares

/// A contour as a function of the share t of its length.
class ContourByShare {
 public:
  explicit ContourByShare(const Polyline& points)
      : points_(points), lengths_(arc_lengths(points)) {}
  double length() const { return lengths_.back(); }
  Point<2> at(double t) const { return point_at_length(points_, lengths_, t * length()); }
  /// Where the contour is nearest to a point.
  struct Nearest {
    double share, distance;
  };
  Nearest nearest(const Point<2>& p) const {
    const NearestPlace place = nearest_place(points_, false, p);
    return {place.length / length(), place.distance};
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
  if (options.known.fixed.size() != options.known.moving.size()) {
    throw InvalidInput("contour pairs: known pairs need as many moving points as fixed ones.");
  }
  if (!options.stretch) return;
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

/// Places of the two contours that correspond, as shares of their lengths, and the number of the pair there.
struct Knot {
  double number = 0, fixed = 0, moving = 0;
};

/// The correspondence of two contours: linear in the pairs' numbers between knots.
class Correspondence {
 public:
  Correspondence(const ContourByShare& fixed, const ContourByShare& moving, int last)
      : fixed_(fixed), moving_(moving), last_(last), knots_({{0, 0, 0}, {double(last), 1, 1}}) {}

  /// False where it would fold the correspondence.
  bool add(Knot knot) {
    const auto after = std::ranges::find_if(
        knots_, [&](const Knot& other) { return other.number >= knot.number; });
    if (after == knots_.begin() || after == knots_.end()) return false;
    if (!grows(*std::prev(after), knot) || !grows(knot, *after)) return false;
    knots_.insert(after, knot);
    return true;
  }
  /// Beyond the outermost inner knots, where they lie near the ends, goes on equally far on both contours.
  void free_ends() {
    constexpr double kQuarter = 0.25;
    if (std::ssize(knots_) < 3) return;
    const double ratio = fixed_.length() / moving_.length();
    Knot &first = knots_.front(), &end = knots_.back();
    const Knot second = knots_[1], second_last = knots_[knots_.size() - 2];
    if (second.fixed < kQuarter) first.moving = second.moving - ratio * second.fixed;
    if (second_last.fixed > 1 - kQuarter) {
      end.moving = second_last.moving + ratio * (1 - second_last.fixed);
    }
  }
  Knot at(int number) const {
    std::size_t k = 1;
    while (k + 1 < knots_.size() && knots_[k].number < number) ++k;
    const Knot &a = knots_[k - 1], &b = knots_[k];
    const double share = (number - a.number) / (b.number - a.number);
    return {double(number), a.fixed + share * (b.fixed - a.fixed),
            a.moving + share * (b.moving - a.moving)};
  }
  /// The knot of two points; its number is that of their mean share.
  Knot knot_of(const Point<2>& fixed, const Point<2>& moving) const {
    Knot knot{0, fixed_.nearest(fixed).share, moving_.nearest(moving).share};
    knot.number = 0.5 * (knot.fixed + knot.moving) * last_;
    return knot;
  }

 private:
  static bool grows(const Knot& a, const Knot& b) {
    constexpr double kLeast = 1e-3;  // of the length
    return b.number > a.number && b.fixed - a.fixed > kLeast && b.moving - a.moving > kLeast;
  }

  const ContourByShare &fixed_, &moving_;
  int last_;
  std::vector<Knot> knots_;
};

/// Splits the contours at known pairs that lie on them.
int add_anchors(const ContourByShare& fixed, const ContourByShare& moving,
                const ContourPairOptions& options, Correspondence& correspondence) {
  int count = 0;
  for (std::size_t i = 0; i < options.known.fixed.size(); ++i) {
    const Point<2>&p = options.known.fixed[i], &q = options.known.moving[i];
    if (fixed.nearest(p).distance > options.anchor_mm) continue;
    if (moving.nearest(q).distance > options.anchor_mm) continue;
    count += correspondence.add(correspondence.knot_of(p, q)) ? 1 : 0;
  }
  if (count > 0) correspondence.free_ends();
  return count;
}

}  // namespace

ContourPairs contour_pairs(const Polyline& fixed, const Polyline& moving,
                           const std::optional<Point<2>>& fixed_nipple,
                           const std::optional<Point<2>>& moving_nipple,
                           const ContourPairOptions& options) {
  check(fixed, moving, options);
  const ContourByShare on_fixed(fixed), on_moving(moving);
  const int last = options.count - 1;
  ContourPairs pairs;
  pairs.fixed_length_mm = on_fixed.length();
  pairs.moving_length_mm = on_moving.length();
  Correspondence correspondence(on_fixed, on_moving, last);
  int nipple_number = -1;
  if (!options.stretch) {
    pairs.num_anchors = add_anchors(on_fixed, on_moving, options, correspondence);
    if (options.use_nipples && fixed_nipple && moving_nipple) {
      Knot nipple = correspondence.knot_of(*fixed_nipple, *moving_nipple);
      nipple.number = std::clamp(std::round(nipple.number), 1.0, last - 1.0);
      pairs.nipple_used = correspondence.add(nipple);
      if (pairs.nipple_used) nipple_number = static_cast<int>(nipple.number);
    }
  }
  for (int k = 0; k <= last; ++k) {
    Knot t = correspondence.at(k);
    if (options.stretch) t.moving = std::clamp(options.stretch(t.fixed), 0.0, 1.0);
    if (t.moving < -kRounding || t.moving > 1 + kRounding) continue;
    pairs.landmarks.fixed.push_back(on_fixed.at(t.fixed));
    pairs.landmarks.moving.push_back(on_moving.at(t.moving));
    pairs.landmarks.names.push_back(k == nipple_number ? "nipple" : message("contour ", k + 1));
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
