#include "Transforms/Domains/VertexClouds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "Core/Error.h"

namespace crease {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;
constexpr double kGoldenAngle = 2.39996;
constexpr double kStraight = 1 * kDegree;  // smaller turns count as none
constexpr double kCorner = 60 * kDegree;   // larger turns are corners
constexpr double kJunctionRadius = 0.5;    // over the smallest inradius
constexpr double kStraightBorder = 1e-7;   // radians

Vector<2> direction(double angle) { return {std::cos(angle), std::sin(angle)}; }
Vector<2> turned(const Vector<2>& v, double angle) {
  const Vector<2> c = direction(angle);
  return {c.x() * v.x() - c.y() * v.y(), c.y() * v.x() + c.x() * v.y()};
}

/// `count` knots on two rays in turn: at the full distance, then at a half and a quarter.
std::vector<Vector<2>> on_two_rays(const Vector<2>& first, const Vector<2>& second, int count) {
  constexpr std::array kDistances = {1.0, 1.0, 0.5, 0.25};
  std::vector<Vector<2>> pattern;
  for (int k = 0; k < count; ++k)
    pattern.emplace_back(kDistances[k] * (k % 2 == 0 ? first : second));
  return pattern;
}

}  // namespace

std::vector<LineEdge> line_edges(const DomainMesh& domain, const MeshTopology& topology) {
  std::vector<LineEdge> result(topology.edges().size());
  for (const auto& chain : domain.chains) {
    for (int e = 0; e < chain.num_edges(); ++e) {
      const int a = chain.vertices[e], b = chain.vertices[(e + 1) % chain.vertices.size()];
      const int edge = topology.edge_between(a, b);
      if (edge < 0) {
        throw InvalidInput(message("place_knots: line ", chain.name, " joins vertices ", a, " and ",
                                   b, ", which are no edge of the mesh."));
      }
      LineEdge& line = result[edge];
      if (chain.body == BodySide::kNone) {
        line.body_left = line.body_right = true;
      } else {
        ((chain.body == BodySide::kLeft) == (a < b) ? line.body_left : line.body_right) = true;
      }
      line.is_line = true;
      if (chain.corner == CornerRule::kCollapse) line.corner = CornerRule::kCollapse;
    }
  }
  return result;
}

VertexClouds::VertexClouds(const DomainMesh& domain, const MeshTopology& topology,
                           const std::vector<LineEdge>& lines, const KnotOptions& options)
    : domain_(domain), topology_(topology), lines_(lines), options_(options) {
  num_distinct_ = options.smoothness < 0 ? options.degree - 1 : options.smoothness;
  Point<2> upper = lower_ = point(0);
  for (const auto& p : domain.mesh.vertices) {
    lower_ = lower_.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  extent_ = upper - lower_;
}

double VertexClouds::smallest_inradius(int vertex) const {
  double smallest = std::numeric_limits<double>::infinity();
  for (int t : topology_.triangles_at(vertex)) {
    const auto& s = domain_.mesh.simplices[t];
    const Vector<2> a = point(s[1]) - point(s[0]), b = point(s[2]) - point(s[1]);
    const double perimeter = a.norm() + b.norm() + (point(s[0]) - point(s[2])).norm();
    smallest = std::min(smallest, cross(a, b) / perimeter);
  }
  return smallest;
}

bool VertexClouds::inside_one_body(int vertex) const {
  const auto& triangles = topology_.triangles_at(vertex);
  const int region = domain_.mesh.region(triangles.front());
  return region > 0 && std::all_of(triangles.begin(), triangles.end(),
                                   [&](int t) { return domain_.mesh.region(t) == region; });
}

/// First directions spread over all vertices by a fast linear function of the place, so that they do not
/// depend on how the vertices are numbered.
std::vector<Vector<2>> VertexClouds::generic_pattern(int vertex, double turn) const {
  double start = 0.4 + turn;
  if (!options_.structured) {
    const Vector<2> place = (point(vertex) - lower_).cwiseQuotient(extent_);
    start += 2 * kPi * (12.9898 * place.x() + 78.233 * place.y());
  }
  std::vector<Vector<2>> pattern;
  for (int k = 1; k <= num_distinct_; ++k) pattern.push_back(direction(start + kGoldenAngle * k));
  return pattern;
}

void VertexClouds::collapse(CloudSketch& sketch, VertexRule rule) const {
  sketch.plan.rule = rule;
  sketch.plan.radius = 0;
  sketch.generic = false;
  sketch.pattern.assign(num_distinct_, Vector<2>::Zero());
}

std::optional<VertexClouds::Corner> VertexClouds::border_corner(int vertex) const {
  const auto& edges = topology_.border_edges_at(vertex);
  if (edges.size() != 2) return std::nullopt;
  Corner corner{Vector<2>::Zero(), Vector<2>::Zero()};
  for (int e : edges) {
    // The border edge leaves `vertex` if its triangle names it right before the other end.
    const auto& s = domain_.mesh.simplices[topology_.edges()[e].triangles[0]];
    const int k = static_cast<int>(std::find(s.begin(), s.end(), vertex) - s.begin());
    const int w = other(e, vertex);
    if (s[(k + 1) % 3] == w) {
      corner.out = (point(w) - point(vertex)).normalized();
    } else {
      corner.in = (point(vertex) - point(w)).normalized();
    }
  }
  return corner;
}

void VertexClouds::set_border(int vertex, const std::vector<int>& line_edges, CloudSketch& sketch,
                              std::vector<std::string>& warnings) const {
  const Point<2>& v = point(vertex);
  const auto corner = border_corner(vertex);
  if (!corner) {
    warnings.push_back(message("parts of the domain touch in the point (", v.x(), ", ", v.y(),
                               ") mm only: its knots were collapsed."));
    return collapse(sketch, VertexRule::kCollapsed);
  }
  const auto& [in, out] = *corner;
  const double turn = turn_angle(in, out);
  sketch.plan.rule = VertexRule::kBorder;
  if (options_.border != BorderRule::kOutside) {
    const bool straight = options_.border == BorderRule::kOnStraightBorder &&
                          std::abs(turn) < kStraightBorder && line_edges.empty();
    if (!straight) return collapse(sketch, VertexRule::kCollapsed);
    const Vector<2> along = (in + out).normalized();
    sketch.pattern = on_two_rays(along, -along, num_distinct_);
    return;
  }
  if (line_edges.size() == 1) {
    const Vector<2> outwards = (v - point(other(line_edges[0], vertex))).normalized();
    if (cross(in, outwards) > 1e-12 || cross(out, outwards) > 1e-12) {
      warnings.push_back(message("a line meets the border at (", v.x(), ", ", v.y(),
                                 ") mm, but its prolongation runs back into the domain: the knots "
                                 "were collapsed."));
      return collapse(sketch, VertexRule::kCollapsed);
    }
    sketch.plan.rule = VertexRule::kBorderMeeting;
    sketch.plan.radius *= kJunctionRadius / options_.alpha;
    for (int k = 1; k <= num_distinct_; ++k)
      sketch.pattern.emplace_back(outwards * (1 - 0.25 * (k - 1)));
    return;
  }
  if (line_edges.size() > 1) {
    sketch.plan.rule = VertexRule::kJunction;
    sketch.plan.radius *= kJunctionRadius / options_.alpha;
  }
  const Vector<2> first = turn >= 0 ? Vector<2>(-out) : Vector<2>(-in);
  const double low = std::atan2(first.y(), first.x()), width = kPi - std::abs(turn);
  for (int k = 1; k <= num_distinct_; ++k) {
    const double shift = k % 2 == 1 ? 0.2 : -0.2;
    sketch.pattern.push_back(direction(low + width * (k - 0.5 + shift) / options_.degree));
  }
}

bool VertexClouds::body_left_of(int edge, int from) const {
  const LineEdge& line = lines_[edge];
  return topology_.edges()[edge].vertices[0] == from ? line.body_left : line.body_right;
}

VertexClouds::Passage VertexClouds::passage(int vertex, int first_edge, int second_edge) const {
  int before = first_edge, after = second_edge;
  const auto body_on_left = [&](int in, int out) {
    return lines_[in].one_body() && lines_[out].one_body() && body_left_of(in, other(in, vertex)) &&
           body_left_of(out, vertex);
  };
  Passage passage;
  passage.body = true;
  if (body_on_left(second_edge, first_edge)) {
    std::swap(before, after);
  } else if (!body_on_left(first_edge, second_edge)) {
    passage.body = false;
  }
  const Vector<2> in = point(vertex) - point(other(before, vertex));
  const Vector<2> out = point(other(after, vertex)) - point(vertex);
  passage.in = in.normalized();
  passage.out = out.normalized();
  passage.shorter_edge = std::min(in.norm(), out.norm());
  if (lines_[before].corner == CornerRule::kCollapse ||
      lines_[after].corner == CornerRule::kCollapse) {
    passage.corner = CornerRule::kCollapse;
  }
  // Without a body no direction is better than the other: take one that depends on the place alone.
  if (!passage.body && (passage.in + passage.out).dot(Vector<2>(0.8, 0.6)) < 0) {
    std::swap(passage.in, passage.out);
    passage.in = -passage.in;
    passage.out = -passage.out;
  }
  return passage;
}

void VertexClouds::set_passage(int vertex, const Passage& passage, CloudSketch& sketch) const {
  const double turn = turn_angle(passage.in, passage.out);
  const bool is_corner = std::abs(turn) > kCorner;
  sketch.plan.turn_deg = std::abs(turn) / kDegree;
  sketch.plan.chord_offset = passage.shorter_edge * std::abs(turn) / 8;
  if (is_corner && passage.corner == CornerRule::kCollapse) {
    return collapse(sketch, VertexRule::kCollapsed);
  }
  const double factor = is_corner      ? options_.fan_corner
                        : passage.body ? options_.fan_body
                                       : options_.fan_both;
  sketch.plan.radius = factor * passage.shorter_edge;
  if (std::abs(turn) < kStraight || !passage.body) {
    const Vector<2> tangent = (passage.in + passage.out).normalized();
    sketch.pattern = on_two_rays(tangent, -tangent, num_distinct_);
    sketch.plan.rule = std::abs(turn) < kStraight ? VertexRule::kStraight : VertexRule::kTangent;
  } else if (turn > 0) {  // convex: both edges prolonged
    sketch.pattern = on_two_rays(passage.in, -passage.out, num_distinct_);
    sketch.plan.rule = VertexRule::kFanned;
  } else {  // concave: on the edges themselves
    sketch.pattern = on_two_rays(passage.out, -passage.in, num_distinct_);
    sketch.plan.rule = VertexRule::kFanned;
  }
  if (is_corner) sketch.plan.rule = VertexRule::kCorner;
  if (sketch.plan.rule != VertexRule::kStraight) avoid_mesh_edges(vertex, sketch);
}

/// A mesh edge along a line through three knots of its vertex would become a crease too: turn that line
/// by two degrees, away from the body if there is one.
void VertexClouds::avoid_mesh_edges(int vertex, CloudSketch& sketch) const {
  for (std::size_t k = 0; k < std::min<std::size_t>(2, sketch.pattern.size()); ++k) {
    const Vector<2> ray = sketch.pattern[k];
    int on_ray = 1, on_both = 1;  // the vertex itself
    for (const auto& knot : sketch.pattern) {
      if (std::abs(cross(ray, knot)) > 1e-9) continue;
      ++on_both;
      if (ray.dot(knot) > 0) ++on_ray;
    }
    const bool through = on_both > on_ray;  // knots on both sides of the vertex
    if (on_both < 3) continue;
    for (int e : topology_.edges_at(vertex)) {
      if (lines_[e].is_line) continue;
      const Vector<2> edge = point(other(e, vertex)) - point(vertex);
      const double angle = turn_angle(ray, edge);
      const bool near =
          std::abs(angle) < kStraight || (through && std::abs(angle) > kPi - kStraight);
      if (!near) continue;
      // Outwards: clockwise for the first ray, counter-clockwise for the second; on a tangent, both alike.
      const double by = (k == 0 || through ? -2 : 2) * kDegree;
      for (auto& knot : sketch.pattern) {
        if (std::abs(cross(ray, knot)) <= 1e-9) knot = turned(knot, by);
      }
      break;
    }
    if (through) break;
  }
}

CloudSketch VertexClouds::sketch(int vertex, std::vector<std::string>& warnings) const {
  CloudSketch sketch;
  std::vector<int> at_vertex;
  if (options_.creases) {
    for (int e : topology_.edges_at(vertex)) {
      if (lines_[e].is_line) at_vertex.push_back(e);
    }
  }
  sketch.on_line = !at_vertex.empty();
  sketch.plan.radius = options_.alpha * smallest_inradius(vertex);
  if (options_.collapse_all) {
    collapse(sketch, VertexRule::kCollapsed);
  } else if (options_.collapse_inside_bodies && at_vertex.empty() && inside_one_body(vertex)) {
    collapse(sketch, VertexRule::kInsideBody);
  } else if (topology_.on_border(vertex)) {
    set_border(vertex, at_vertex, sketch, warnings);
  } else if (at_vertex.size() == 2) {
    set_passage(vertex, passage(vertex, at_vertex[0], at_vertex[1]), sketch);
  } else {
    sketch.generic = true;
    sketch.pattern = generic_pattern(vertex, 0);
    if (at_vertex.size() == 1) sketch.plan.rule = VertexRule::kLineEnd;
    if (at_vertex.size() > 2) {
      sketch.plan.rule = VertexRule::kJunction;
      sketch.plan.radius *= kJunctionRadius / options_.alpha;
    }
  }
  return sketch;
}

}  // namespace crease
