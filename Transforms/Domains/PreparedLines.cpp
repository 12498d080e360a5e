#include <algorithm>
#include <cmath>
#include <limits>

#include "Core/Error.h"
#include "Transforms/Domains/CurveSampling.h"
#include "Transforms/Domains/LineArrangement.h"

namespace crease {
namespace {

bool before(const Point<2>& p, const Point<2>& q) {
  return p.x() < q.x() || (p.x() == q.x() && p.y() < q.y());
}

std::string describe(const FeatureLine& line) {
  return line.name.empty() ? std::string("a feature line") : message("feature line ", line.name);
}

/// The same line in a direction, and a closed one with a start, that do not depend on how it was given.
FeatureLine canonical(FeatureLine line) {
  line.body = body_side(line);
  const bool backwards = line.body == BodySide::kRight ||
                         (line.body == BodySide::kNone &&
                          (line.closed ? signed_area(line.points) < 0
                                       : before(line.points.back(), line.points.front())));
  if (backwards) line = reversed(line);
  if (line.closed) {
    const auto first = std::min_element(line.points.begin(), line.points.end(), before);
    std::rotate(line.points.begin(), first, line.points.end());
  }
  return line;
}

/// Where segment ab meets the region's rings, as parameters in (0, 1), ascending.
std::vector<double> border_crossings(const RegionOfInterest& region, const Point<2>& a,
                                     const Point<2>& b) {
  std::vector<double> parameters;
  const Point<2> lower = a.cwiseMin(b), upper = a.cwiseMax(b);
  const double length2 = (b - a).squaredNorm();
  const auto add = [&](const Point<2>& p) {
    const double t = (p - a).dot(b - a) / length2;
    if (t > 0 && t < 1) parameters.push_back(t);
  };
  for (const auto& ring : region.rings()) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Point<2>&c = ring[k], &d = ring[(k + 1) % ring.size()];
      if ((c.cwiseMax(d).array() < lower.array()).any()) continue;
      if ((c.cwiseMin(d).array() > upper.array()).any()) continue;
      if (const auto p = segment_crossing(a, b, c, d)) add(*p);
      // Ends of collinear stretches.
      for (const auto& end : {c, d}) {
        if ((end - closest_point_on_segment(end, a, b)).squaredNorm() <= 1e-24 * length2) add(end);
      }
    }
  }
  std::sort(parameters.begin(), parameters.end());
  return parameters;
}

bool is_inside(const RegionOfInterest& region, const Point<2>& p, double tolerance) {
  return region.contains(p) && std::ranges::all_of(region.rings(), [&](const Polyline& ring) {
           return distance_to_polyline(ring, true, p) > tolerance;
         });
}

void thin_out(FeatureLine& line, double distance, std::vector<std::string>& notes) {
  Polyline kept;
  double shift = 0;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const bool is_end = !line.closed && i + 1 == line.points.size();
    if (is_end && kept.size() > 1 && (line.points[i] - kept.back()).norm() < distance) {
      kept.pop_back();
    }
    if (kept.empty() || is_end || (line.points[i] - kept.back()).norm() >= distance) {
      kept.push_back(line.points[i]);
    }
  }
  while (line.closed && kept.size() > 3 && (kept.back() - kept.front()).norm() < distance) {
    kept.pop_back();
  }
  if (kept.size() == line.points.size()) return;
  for (const auto& p : line.points) {
    shift = std::max(shift, distance_to_polyline(kept, line.closed, p));
  }
  notes.push_back(
      message(describe(line), ": ", line.points.size() - kept.size(),
              " points nearer than a quarter edge to their neighbours were merged; the ",
              "line moved by at most ", shift, " mm."));
  line.points = std::move(kept);
}

void sample_line(FeatureLine& line, const LineArrangementOptions& options,
                 std::vector<std::string>& notes) {
  const auto length = [&](const Point<2>&) { return options.edge_length; };
  CurveSamplingOptions sampling{.tolerance = options.tolerance, .keep_area = true};
  if (!options.resample || !is_dense(line.points, line.closed, length)) {
    thin_out(line, 0.25 * options.edge_length, notes);
    if (!options.resample) return;
    sampling = {.tolerance = 0, .smallest_edge = 0};  // keeps all points
  }
  auto sampled = sample_curve(line.points, line.closed, length, sampling);
  if (sampled.points.size() != line.points.size()) {
    notes.push_back(message(describe(line), ": sampled from ", line.points.size(), " to ",
                            sampled.points.size(), " points, at most ", sampled.largest_offset,
                            " mm off, largest turn ", sampled.largest_turn_deg, " degrees."));
  }
  line.points = std::move(sampled.points);
}

}  // namespace

std::vector<FeatureLine> clipped_to_region(const FeatureLine& line,
                                           const RegionOfInterest& region) {
  const double tolerance = 1e-9 * region.bounds().diagonal();
  std::vector<FeatureLine> pieces;
  FeatureLine empty = line;
  empty.points.clear();
  empty.closed = false;
  bool open_piece = false, all_inside = true;
  const auto add = [&](const Point<2>& a, const Point<2>& b) {
    if (!is_inside(region, 0.5 * (a + b), tolerance)) {
      open_piece = all_inside = false;
      return;
    }
    if (!open_piece) {
      pieces.push_back(empty);
      pieces.back().points.push_back(a);
      open_piece = true;
    }
    pieces.back().points.push_back(b);
  };
  for (int e = 0; e < line.num_edges(); ++e) {
    const Point<2>& a = line.points[e];
    const Point<2>& b = line.points[(e + 1) % line.points.size()];
    if (a == b) continue;
    const auto parameters = border_crossings(region, a, b);
    Point<2> from = a;
    for (double t : parameters) {
      const Point<2> to = a + t * (b - a);
      if ((to - from).norm() <= tolerance || (b - to).norm() <= tolerance) continue;
      add(from, to);
      from = to;
    }
    add(from, b);
  }
  if (all_inside) return {line};
  if (line.closed && open_piece && pieces.size() > 1 &&
      pieces.front().points.front() == pieces.back().points.back()) {
    auto& last = pieces.back().points;
    last.insert(last.end(), pieces.front().points.begin() + 1, pieces.front().points.end());
    pieces.erase(pieces.begin());
  }
  return pieces;
}

std::vector<FeatureLine> prepared_lines(const RegionOfInterest& region,
                                        const std::vector<FeatureLine>& lines,
                                        const LineArrangementOptions& options,
                                        std::vector<std::string>& notes,
                                        std::vector<std::string>& warnings) {
  std::vector<FeatureLine> result;
  for (const auto& given : lines) {
    FeatureLine line = canonical(given);
    if (looks_like_pixel_stairs(line.points, line.closed)) {
      warnings.push_back(message(describe(line), " looks like pixel stairs: more than half of its ",
                                 "turns exceed 30 degrees; smooth it first."));
    }
    auto pieces = clipped_to_region(line, region);
    const double length = polyline_length(line.points, line.closed);
    double kept = 0;
    for (const auto& piece : pieces) kept += polyline_length(piece.points, piece.closed);
    // Outlines of label images reach outside without anybody's mistake.
    const bool from_labels = given.left_label > 0 || given.right_label > 0;
    if (pieces.empty() && !from_labels) {
      throw InvalidInput(message(describe(line),
                                 " lies wholly outside the region of interest, from (",
                                 line.points[0].x(), ", ", line.points[0].y(), ") mm on."));
    }
    if (length - kept > 1e-9 * length) {
      auto& list = length - kept > options.edge_length && !from_labels ? warnings : notes;
      list.push_back(
          message(describe(line), ": ", 100 * (length - kept) / length,
                  " % of it is outside the region of interest, or on its border, and cut off."));
    }
    for (auto& piece : pieces) {
      constexpr double kShortestEdge = 0.25;  // over the edge length: nearer points are merged
      if (piece.closed && !from_labels &&
          polyline_length(piece.points, true) < 3 * kShortestEdge * options.edge_length) {
        throw InvalidInput(message(describe(piece),
                                   ": the closed line is shorter than three edges of ",
                                   kShortestEdge * options.edge_length,
                                   " mm, a quarter of those near lines; use shorter edges or leave "
                                   "it out."));
      }
      if (polyline_length(piece.points, piece.closed) < 0.25 * options.edge_length) {
        notes.push_back(
            message(describe(line), ": a piece shorter than a quarter edge is left out."));
        continue;
      }
      sample_line(piece, options, notes);
      result.push_back(std::move(piece));
    }
  }
  std::sort(result.begin(), result.end(), [](const FeatureLine& l, const FeatureLine& m) {
    const Point<2>&p = l.points.front(), &q = m.points.front();
    if (p != q) return before(p, q);
    if (l.points[1] != m.points[1]) return before(l.points[1], m.points[1]);
    return l.points.size() < m.points.size();
  });
  return result;
}

}  // namespace crease
