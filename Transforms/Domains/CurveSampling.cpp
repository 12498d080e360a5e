#include "Transforms/Domains/CurveSampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "Transforms/Domains/ArcLength.h"

namespace crease {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kKeptTurn = 3 * kDegree;  // corners of coarse polylines that turn more stay

/// A curve as dense points with arc length and, per point, the wanted edge length and the turn there.
struct DenseCurve {
  Polyline points;
  std::vector<double> s;       // arc length from the first point, mm
  std::vector<double> wanted;  // edge length, mm
  std::vector<double> turn;    // at the point, radians; 0 at ends
  std::vector<char> original;

  int size() const { return static_cast<int>(points.size()); }
  Point<2> at(double length) const { return point_at_length(points, s, length); }
};

/// Divides long edges so that densities can be integrated point by point. A closed curve ends in its
/// first point again.
DenseCurve make_dense(Polyline points, bool closed,
                      const std::function<double(const Point<2>&)>& edge_length) {
  if (closed) points.push_back(points.front());
  DenseCurve dense;
  const auto add = [&](const Point<2>& p, double wanted, bool original) {
    dense.points.push_back(p);
    dense.wanted.push_back(wanted);
    dense.original.push_back(original);
  };
  add(points[0], edge_length(points[0]), true);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector<2> edge = points[i] - points[i - 1];
    const double wanted = edge_length(points[i]);
    const double step = 0.25 * std::min(wanted, dense.wanted.back());
    const int count = static_cast<int>(std::min(edge.norm() / step, 1e6)) + 1;
    for (int k = 1; k < count; ++k) {
      const Point<2> p = points[i - 1] + static_cast<double>(k) / count * edge;
      add(p, edge_length(p), false);
    }
    add(points[i], wanted, true);
  }
  dense.s = arc_lengths(dense.points);
  const int n = dense.size();
  dense.turn.assign(n, 0);
  for (int i = 1; i + 1 < n; ++i) {
    if (!dense.original[i]) continue;
    dense.turn[i] =
        turn_angle(dense.points[i] - dense.points[i - 1], dense.points[i + 1] - dense.points[i]);
  }
  if (closed) {
    dense.turn[0] = dense.turn[n - 1] =
        turn_angle(dense.points[n - 1] - dense.points[n - 2], dense.points[1] - dense.points[0]);
  }
  return dense;
}

/// Samples the stretch between two dense points that both stay.
class StretchSampler {
 public:
  StretchSampler(const DenseCurve& curve, const CurveSamplingOptions& options)
      : curve_(curve), options_(options) {
    set_lengths();
  }

  /// Appends arc lengths of the samples after `first` up to and including `last`.
  void sample(int first, int last, int fewest, std::vector<double>& samples) const;

 private:
  void set_lengths();
  std::vector<double> evenly(int first, int last, int count) const;
  int farthest(int first, int last, const std::vector<double>& inner, double& distance) const;

  const DenseCurve& curve_;
  const CurveSamplingOptions& options_;
  std::vector<double> lengths_;  // local edge lengths, from the wish and the curvature
};

void StretchSampler::set_lengths() {
  const int n = curve_.size();
  lengths_ = curve_.wanted;
  std::vector<double> angle(n + 1, 0);  // sum of the turns before a point
  for (int i = 0; i < n; ++i) angle[i + 1] = angle[i] + (i > 0 && i + 1 < n ? curve_.turn[i] : 0);
  int low = 0, high = 0;
  for (int i = 0; i < n; ++i) {
    const double window = 0.25 * curve_.wanted[i];
    while (low < i && curve_.s[low] < curve_.s[i] - window) ++low;
    high = std::max(high, i);
    while (high + 1 < n && curve_.s[high + 1] <= curve_.s[i] + window) ++high;
    const double width = std::max(curve_.s[high] - curve_.s[low], window);
    const double curvature = std::abs(angle[high + 1] - angle[low]) / width;
    if (curvature <= 0) continue;
    double length = options_.max_turn_deg * kDegree / curvature;
    if (options_.tolerance > 0) {
      length = std::min(length, std::sqrt(8 * options_.tolerance / curvature));
    }
    lengths_[i] = std::clamp(length, options_.smallest_edge * curve_.wanted[i], curve_.wanted[i]);
  }
  // Neighbouring edges differ by at most about a third.
  for (int i = 1; i < n; ++i) {
    const double step = curve_.s[i] - curve_.s[i - 1];
    lengths_[i] = std::min(lengths_[i], lengths_[i - 1] + 0.3 * step);
  }
  for (int i = n - 2; i >= 0; --i) {
    const double step = curve_.s[i + 1] - curve_.s[i];
    lengths_[i] = std::min(lengths_[i], lengths_[i + 1] + 0.3 * step);
  }
}

/// Arc lengths of count - 1 points that divide the integral of 1 / length into equal parts; for count = 0
/// the count follows from the integral.
std::vector<double> StretchSampler::evenly(int first, int last, int count) const {
  std::vector<double> integral{0};
  for (int i = first; i < last; ++i) {
    const double step = curve_.s[i + 1] - curve_.s[i];
    integral.push_back(integral.back() + 0.5 * step * (1 / lengths_[i] + 1 / lengths_[i + 1]));
  }
  if (count == 0) count = std::max(1, static_cast<int>(std::lround(integral.back())));
  std::vector<double> result;
  int i = 0;
  for (int k = 1; k < count; ++k) {
    const double wanted = integral.back() * k / count;
    while (i + 1 < last - first && integral[i + 1] < wanted) ++i;
    const double part = integral[i + 1] - integral[i];
    const double t = part > 0 ? (wanted - integral[i]) / part : 0;
    result.push_back(curve_.s[first + i] + t * (curve_.s[first + i + 1] - curve_.s[first + i]));
  }
  return result;
}

/// The original point that the samples miss by most.
int StretchSampler::farthest(int first, int last, const std::vector<double>& inner,
                             double& distance) const {
  std::vector<double> knots{curve_.s[first]};
  knots.insert(knots.end(), inner.begin(), inner.end());
  knots.push_back(curve_.s[last]);
  int result = -1;
  std::size_t k = 0;
  distance = 0;
  for (int i = first + 1; i < last; ++i) {
    if (!curve_.original[i]) continue;
    while (k + 2 < knots.size() && knots[k + 1] < curve_.s[i]) ++k;
    const Point<2> a = curve_.at(knots[k]), b = curve_.at(knots[k + 1]);
    const double d = (curve_.points[i] - closest_point_on_segment(curve_.points[i], a, b)).norm();
    if (d > distance) {
      distance = d;
      result = i;
    }
  }
  return result;
}

void StretchSampler::sample(int first, int last, int fewest, std::vector<double>& samples) const {
  std::vector<double> inner = evenly(first, last, 0);
  if (static_cast<int>(inner.size()) + 1 < fewest) inner = evenly(first, last, fewest);
  double distance = 0;
  const int worst = farthest(first, last, inner, distance);
  if (worst >= 0 && distance > options_.tolerance) {
    const double room = options_.smallest_edge * curve_.wanted[worst];
    if (curve_.s[worst] - curve_.s[first] >= room && curve_.s[last] - curve_.s[worst] >= room) {
      sample(first, worst, 1, samples);
      sample(worst, last, 1, samples);
      return;
    }
  }
  samples.insert(samples.end(), inner.begin(), inner.end());
  samples.push_back(curve_.s[last]);
}

/// Corners of coarse polylines: both edges are about as long as wanted, or longer.
std::vector<int> kept_points(const DenseCurve& curve, bool closed) {
  const int n = curve.size();
  std::vector<int> originals, kept;
  for (int i = 0; i < n; ++i) {
    if (curve.original[i]) originals.push_back(i);
  }
  const int m = static_cast<int>(originals.size());
  for (int k = 0; k < m; ++k) {
    const int i = originals[k];
    if (k == 0 || k == m - 1) {
      if (!closed) kept.push_back(i);
      if (!closed || k == m - 1) continue;
    }
    const double before =
        k > 0 ? curve.s[i] - curve.s[originals[k - 1]] : curve.s[n - 1] - curve.s[originals[m - 2]];
    const double after = curve.s[originals[k + 1]] - curve.s[i];
    const bool coarse = std::min(before, after) >= 0.5 * curve.wanted[i];
    if (coarse && std::abs(curve.turn[i]) > kKeptTurn) kept.push_back(i);
  }
  return kept;
}

/// Twice the signed area between curve and chord from arc length a to b, positive where the curve runs to
/// the right of the chord.
double twice_area_beside_chord(const DenseCurve& curve, double a, double b) {
  const Point<2> start = curve.at(a), end = curve.at(b);
  double sum = 0;
  Point<2> previous = start;
  const auto first = std::upper_bound(curve.s.begin(), curve.s.end(), a) - curve.s.begin();
  for (auto i = first; i < curve.size() && curve.s[i] < b; ++i) {
    sum += cross(previous - start, curve.points[i] - start);
    previous = curve.points[i];
  }
  return sum + cross(previous - start, end - start);
}

/// Moves each vertex outwards by the mean height of the two slices beside it.
void balance_areas(const DenseCurve& curve, const std::vector<double>& samples, bool closed,
                   const std::vector<char>& is_kept, Polyline& points) {
  const int n = static_cast<int>(points.size());
  const Polyline old = points;
  const int edges = closed ? n : n - 1;
  std::vector<double> area(edges);
  for (int e = 0; e < edges; ++e) {
    area[e] = twice_area_beside_chord(curve, samples[e],
                                      e + 1 < n ? samples[e + 1] : curve.s[curve.size() - 1]);
  }
  for (int i = 0; i < n; ++i) {
    if (is_kept[i] || (!closed && (i == 0 || i == n - 1))) continue;
    const int before = (i + n - 1) % n, after = (i + 1) % n;
    const Vector<2> in = old[i] - old[before], out = old[after] - old[i];
    const Vector<2> direction = (old[after] - old[before]).normalized();
    const double shift = 0.5 * (area[before] / in.norm() + area[i] / out.norm()) / 2;
    if (std::isfinite(shift)) points[i] -= shift * turned_left(direction);
  }
}

}  // namespace

double largest_turn_deg(std::span<const Point<2>> points, bool closed) {
  const int n = static_cast<int>(points.size());
  double largest = 0;
  for (int i = closed ? 0 : 1; i < (closed ? n : n - 1); ++i) {
    const Vector<2> in = points[i] - points[(i + n - 1) % n], out = points[(i + 1) % n] - points[i];
    largest = std::max(largest, std::abs(turn_angle(in, out)) / kDegree);
  }
  return largest;
}

bool is_dense(std::span<const Point<2>> points, bool closed,
              const std::function<double(const Point<2>&)>& edge_length) {
  const int edges = static_cast<int>(points.size()) - (closed ? 0 : 1);
  int num_short = 0;
  for (int e = 0; e < edges; ++e) {
    const Vector<2> edge = points[(e + 1) % points.size()] - points[e];
    num_short += edge.norm() < 0.35 * edge_length(points[e]);
  }
  return 2 * num_short > edges;
}

bool looks_like_pixel_stairs(std::span<const Point<2>> points, bool closed) {
  const int n = static_cast<int>(points.size());
  const int turns = closed ? n : n - 2;
  int sharp = 0, alternating = 0;
  double before = 0;
  for (int i = closed ? 0 : 1; i < (closed ? n : n - 1); ++i) {
    const Vector<2> in = points[i] - points[(i + n - 1) % n], out = points[(i + 1) % n] - points[i];
    const double turn = turn_angle(in, out);
    if (std::abs(turn) > 30 * kDegree) ++sharp;
    if (turn * before < 0 && std::min(std::abs(turn), std::abs(before)) > 30 * kDegree) {
      ++alternating;
    }
    before = turn;
  }
  // Small convex polygons turn as sharply, but always to the same side.
  return turns > 0 && 2 * sharp > turns && alternating > 0;
}

SampledCurve sample_curve(std::span<const Point<2>> points, bool closed,
                          const std::function<double(const Point<2>&)>& edge_length,
                          const CurveSamplingOptions& options) {
  Polyline work;
  for (const auto& p : points) {
    if (work.empty() || p != work.back()) work.push_back(p);
  }
  while (closed && work.size() > 1 && work.back() == work.front()) work.pop_back();
  if (work.size() < 2) return {work, 0, 0};
  DenseCurve curve = make_dense(work, closed, edge_length);
  std::vector<int> kept = kept_points(curve, closed);
  if (closed && !kept.empty() && kept[0] != 0) {
    // Start at a corner that stays.
    int first = 0;
    for (int i = 1; i <= kept[0]; ++i) first += curve.original[i];
    std::rotate(work.begin(), work.begin() + first, work.end());
    curve = make_dense(work, closed, edge_length);
    kept = kept_points(curve, closed);
  }
  const bool smooth = kept.empty();      // a closed curve without corners
  for (int i : kept) curve.turn[i] = 0;  // what stays need not be followed by short edges
  if (closed) {
    if (smooth) kept.push_back(0);
    kept.push_back(curve.size() - 1);
  }
  const StretchSampler sampler(curve, options);
  std::vector<double> samples{0};
  for (std::size_t k = 0; k + 1 < kept.size(); ++k) {
    const int fewest = closed && kept.size() == 2 ? 6 : closed && kept.size() == 3 ? 2 : 1;
    sampler.sample(kept[k], kept[k + 1], fewest, samples);
  }
  SampledCurve result;
  for (double s : samples) result.points.push_back(curve.at(s));
  if (closed) result.points.pop_back();
  if (options.keep_area) {
    std::vector<char> is_kept(result.points.size(), 0);
    for (std::size_t k = 0, i = 0; k < kept.size() && !smooth; ++k) {
      while (i < is_kept.size() && samples[i] < curve.s[kept[k]]) ++i;
      if (i < is_kept.size()) is_kept[i] = 1;
    }
    if (closed) samples.pop_back();
    balance_areas(curve, samples, closed, is_kept, result.points);
  }
  for (const auto& p : work) {
    result.largest_offset =
        std::max(result.largest_offset, distance_to_polyline(result.points, closed, p));
  }
  result.largest_turn_deg = largest_turn_deg(result.points, closed);
  return result;
}

}  // namespace crease
