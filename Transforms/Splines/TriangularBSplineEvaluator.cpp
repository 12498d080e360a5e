#include "Transforms/Splines/TriangularBSplineEvaluator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "Core/Cpu.h"
#include "Core/Parallel.h"
#include "Transforms/Domains/MeshTopology.h"
#include "Transforms/Domains/Polygon.h"
#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/KnotPlanes.h"

namespace crease {
namespace {

constexpr int kQuantities[3] = {1, 3, 6};  // for derivatives 0, 1, 2

// A vertex's degree + 1 knots; t_degree = t_0.
std::vector<Point<2>> full_cloud(const KnotNet<2>& net, int vertex) {
  std::vector<Point<2>> cloud = net.clouds[vertex];
  while (static_cast<int>(cloud.size()) <= net.degree) cloud.push_back(cloud[0]);
  return cloud;
}

int nodes_per_triangle(int degree) {  // of the levels 1..degree
  return (degree + 1) * (degree + 2) * (degree + 3) / 6 - 1;
}

}  // namespace

TriangularBSplineEvaluator::TriangularBSplineEvaluator(const KnotNet<2>& net,
                                                       const KnotControlPoints<2>& control_points)
    : degree_(net.degree),
      tie_(kKnotTie * mesh_scale(net.mesh)),
      control_points_(control_points),
      avx2_(cpu_has_avx2()) {
  build_edges(net);
  build_triangles(net);
  set_lines(net);
  find_near_edges(net);
}

void fill_lanes(LanePoints& points, int used) {
  points.lanes = used <= 4 ? 4 : LanePoints::kMaxLanes;
  for (int l = used; l < points.lanes; ++l) {
    points.x[l] = points.x[used - 1];
    points.y[l] = points.y[used - 1];
    points.side_x[l] = points.side_x[used - 1];
    points.side_y[l] = points.side_y[used - 1];
    points.inside_x[l] = points.inside_x[used - 1];
    points.inside_y[l] = points.inside_y[used - 1];
  }
  const auto [left, right] = std::minmax_element(points.side_x, points.side_x + used);
  const auto [low, high] = std::minmax_element(points.side_y, points.side_y + used);
  points.centre_x = 0.5 * (*left + *right);
  points.centre_y = 0.5 * (*low + *high);
  points.half_width = 0.5 * (*right - *left);
  points.half_height = 0.5 * (*high - *low);
}

LaneEdge TriangularBSplineEvaluator::Edge::kernel() const {
  return {terms.origin.x(),
          terms.origin.y(),
          lines.data(),
          terms.leaves.data(),
          terms.nodes.data(),
          terms.slots.data(),
          static_cast<int>(lines.size()),
          static_cast<int>(terms.leaves.size()),
          static_cast<int>(terms.nodes.size())};
}

void TriangularBSplineEvaluator::build_edges(const KnotNet<2>& net) {
  const MeshTopology topology(net.mesh);
  const auto count = std::ssize(topology.edges());
  std::vector<std::optional<Edge>> built(count);
  parallel_for(count, [&](std::int64_t e) {
    const auto& ends = topology.edges()[e].vertices;
    const auto a = full_cloud(net, ends[0]), b = full_cloud(net, ends[1]);
    Edge edge{KnotEdgeTerms(a, b, degree_), {}, topology.edges()[e].triangles, {}, {}, 0, 0, 0, 0};
    edge.along = (b[0] - a[0]).normalized();
    edge.across = turned_left(edge.along);
    edge.along_lower = edge.across_lower = std::numeric_limits<double>::infinity();
    edge.along_upper = edge.across_upper = -edge.along_lower;
    for (const auto& cloud : {a, b}) {
      for (const auto& knot : cloud) {
        edge.along_lower = std::min(edge.along_lower, edge.along.dot(knot) - tie_);
        edge.along_upper = std::max(edge.along_upper, edge.along.dot(knot) + tie_);
        edge.across_lower = std::min(edge.across_lower, edge.across.dot(knot) - tie_);
        edge.across_upper = std::max(edge.across_upper, edge.across.dot(knot) + tie_);
      }
    }
    built[e] = std::move(edge);
  });
  for (auto& edge : built) edges_.push_back(std::move(*edge));

  triangles_.resize(net.mesh.simplices.size());
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const auto& v = net.mesh.simplices[t];
    for (int i = 0; i < 3; ++i) {
      triangles_[t].edges[i] = topology.edge_between(v[(i + 1) % 3], v[(i + 2) % 3]);
      triangles_[t].kernel.flipped[i] = v[(i + 1) % 3] > v[(i + 2) % 3];
    }
  }
}

void TriangularBSplineEvaluator::build_triangles(const KnotNet<2>& net) {
  const int stride = 9 * nodes_per_triangle(degree_);
  lambdas_.resize(triangles_.size() * stride);
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    std::array<std::vector<Point<2>>, 3> clouds;
    for (int j = 0; j < 3; ++j) clouds[j] = full_cloud(net, net.mesh.simplices[t][j]);
    LaneTriangle& kernel = triangles_[t].kernel;
    const Point<2> origin = clouds[0][0];
    kernel.origin_x = origin.x();
    kernel.origin_y = origin.y();
    kernel.base = 1.0 / cross(clouds[1][0] - origin, clouds[2][0] - origin);
    double* lambda = &lambdas_[t * stride];
    kernel.lambda = lambda;
    for (int level = 1; level <= degree_; ++level) {
      for (const auto& beta : multi_indices<2>(level)) {
        Point<2> x[3];
        for (int j = 0; j < 3; ++j) x[j] = clouds[j][beta[j]] - origin;
        const double factor = level == degree_ ? 1.0 : 1.0 / cross(x[1] - x[0], x[2] - x[0]);
        for (int j = 0; j < 3; ++j, lambda += 3) {
          const Point<2>&q = x[(j + 1) % 3], &r = x[(j + 2) % 3];
          lambda[0] = factor * (q.y() - r.y());
          lambda[1] = factor * (r.x() - q.x());
          lambda[2] = factor * cross(q, r);
        }
      }
    }
  }
}

// Lines are shared over the whole net, so that all functions agree about sides.
void TriangularBSplineEvaluator::set_lines(const KnotNet<2>& net) {
  std::vector<std::array<Point<2>, 2>> pairs;
  for (const Edge& edge : edges_) {
    pairs.insert(pairs.end(), edge.terms.pairs.begin(), edge.terms.pairs.end());
  }
  const std::size_t first_side = pairs.size();
  for (const auto& t : net.mesh.simplices) {
    for (int i = 0; i < 3; ++i) {
      pairs.push_back({net.mesh.vertices[t[(i + 1) % 3]], net.mesh.vertices[t[(i + 2) % 3]]});
    }
  }
  const auto merged = merge_planes<2>(pairs, tie_);
  const auto shared_line = [&](std::size_t pair, int& sign) {
    const auto& plane = merged.planes[merged.plane_of_facet[pair]];
    if (cross(pairs[pair][1] - pairs[pair][0], plane.normal) < 0.0) sign = -sign;
    return LaneLine{plane.normal.x(), plane.normal.y(), plane.offset};
  };
  std::size_t next = 0;
  for (Edge& edge : edges_) {
    std::vector<int> turn(edge.terms.pairs.size(), 1);
    for (int& sign : turn) edge.lines.push_back(shared_line(next++, sign));
    for (LaneLeaf& leaf : edge.terms.leaves) {
      for (int j = 0; j < 3; ++j) leaf.sign[j] *= turn[leaf.line[j]];
    }
  }
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      triangles_[t].kernel.inner[i] = 1;
      triangles_[t].kernel.sides[i] =
          shared_line(first_side + 3 * t + i, triangles_[t].kernel.inner[i]);
    }
  }
}

bool TriangularBSplineEvaluator::in_strip(const Edge& edge, double x, double y, double half_width,
                                          double half_height) const {
  const double across = edge.across.x() * x + edge.across.y() * y;
  const double reach_across =
      std::abs(edge.across.x()) * half_width + std::abs(edge.across.y()) * half_height;
  if (across + reach_across < edge.across_lower || across - reach_across > edge.across_upper) {
    return false;
  }
  const double along = edge.along.x() * x + edge.along.y() * y;
  const double reach_along =
      std::abs(edge.along.x()) * half_width + std::abs(edge.along.y()) * half_height;
  return along + reach_along >= edge.along_lower && along - reach_along <= edge.along_upper;
}

// Of the edges at the triangle's vertices and opposite to them: those whose strip's box meets it.
void TriangularBSplineEvaluator::find_near_edges(const KnotNet<2>& net) {
  const auto neighbours = vertex_neighbours(net.mesh);
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const auto corners = simplex_corners(net.mesh, static_cast<int>(t));
    auto& near = triangles_[t].near_edges;
    for (int other : neighbours[t]) {
      for (int e : triangles_[other].edges) {
        const auto meets = [&](const Vector<2>& direction, double lower, double upper) {
          const double h[3] = {direction.dot(corners[0]), direction.dot(corners[1]),
                               direction.dot(corners[2])};
          return std::max({h[0], h[1], h[2]}) >= lower && std::min({h[0], h[1], h[2]}) <= upper;
        };
        const Edge& edge = edges_[e];
        if (meets(edge.across, edge.across_lower, edge.across_upper) &&
            meets(edge.along, edge.along_lower, edge.along_upper)) {
          near.push_back(e);
        }
      }
    }
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
  }
}

std::vector<double> TriangularBSplineEvaluator::breaks_along(int triangle, const Point<2>& a,
                                                             const Point<2>& b) const {
  std::vector<double> breaks;
  for (int e : triangles_[triangle].near_edges) {
    for (const LaneLine& line : edges_[e].lines) {
      const auto distance = [&](const Point<2>& p) {
        return line.nx * p.x() + line.ny * p.y() - line.offset;
      };
      const double at_a = distance(a), at_b = distance(b);
      if (at_a * at_b < 0) breaks.push_back(at_a / (at_a - at_b));
    }
  }
  return breaks;
}

int TriangularBSplineEvaluator::Scratch::slot_of(int control_point) {
  if (point_stamp_[control_point] != stamp_) {
    point_stamp_[control_point] = stamp_;
    point_slot_[control_point] = static_cast<int>(used_.size());
    used_.push_back(control_point);
    nonzero_.push_back(0);
  }
  return point_slot_[control_point];
}

// Edges whose strips the points' box meets, and the triangles that may be not zero.
void TriangularBSplineEvaluator::collect(const LanePoints& points, std::span<const int> holders,
                                         Scratch& s) const {
  const auto grow = [](auto& vector, std::size_t size) {
    if (vector.size() < size) vector.resize(size, 0);
  };
  grow(s.edge_stamp_, edges_.size());
  grow(s.edge_place_, edges_.size());
  grow(s.triangle_stamp_, triangles_.size());
  grow(s.point_stamp_, control_points_.count());
  grow(s.point_slot_, control_points_.count());
  ++s.stamp_;
  s.edges_.clear();
  s.triangles_.clear();
  s.used_.clear();
  s.nonzero_.clear();
  const auto add_triangle = [&](int t) {
    if (t < 0 || s.triangle_stamp_[t] == s.stamp_) return;
    s.triangle_stamp_[t] = s.stamp_;
    s.triangles_.push_back(t);
  };
  for (int holder : holders) {
    add_triangle(holder);
    for (int e : triangles_[holder].near_edges) {
      if (s.edge_stamp_[e] == s.stamp_) continue;
      s.edge_stamp_[e] = s.stamp_;
      s.edge_place_[e] = -1;
      if (!in_strip(edges_[e], points.centre_x, points.centre_y, points.half_width,
                    points.half_height)) {
        continue;
      }
      s.edge_place_[e] = static_cast<int>(s.edges_.size());
      s.edges_.push_back({e, {}, false});
    }
  }
}

void TriangularBSplineEvaluator::evaluate(LanePoints& points, std::span<const int> holders,
                                          int derivatives, Scratch& s) const {
  points.tie = tie_;
  collect(points, holders, s);
  const int lanes = points.lanes;
  const int gradients = 2 * (degree_ + 1) * lanes;
  std::size_t num_values = 0, num_sides = 0;
  for (const auto& active : s.edges_) {
    const LaneEdge e = edges_[active.edge].kernel();
    num_values += e.num_leaves + e.num_nodes;
    num_sides = std::max(num_sides, static_cast<std::size_t>(e.num_lines));
  }
  const std::size_t doubles =
      num_values * lanes + s.edges_.size() * gradients + num_sides * (lanes + 1) + 4;
  if (s.pool_.size() * 4 < doubles) s.pool_.resize(doubles / 4 + 1);
  if (s.flags_.size() < num_values) s.flags_.resize(num_values);

  double* next = s.pool_.empty() ? nullptr : s.pool_[0].v;
  double* sides = next;
  next += (num_sides * (lanes + 1) + 3) / 4 * 4;
  unsigned char* flags = s.flags_.data();
  const auto edge_kernel = avx2_ ? avx2::evaluate_edge : baseline::evaluate_edge;
  for (auto& active : s.edges_) {
    const Edge& edge = edges_[active.edge];
    const LaneEdge e = edge.kernel();
    active.values = {next, flags,
                     next + static_cast<std::size_t>(e.num_leaves + e.num_nodes) * lanes, e.slots};
    next += static_cast<std::size_t>(e.num_leaves + e.num_nodes) * lanes + gradients;
    flags += e.num_leaves + e.num_nodes;
    active.nonzero = edge_kernel(e, points, degree_, derivatives, active.values, sides);
    if (!active.nonzero) continue;
    for (int t : edge.triangles) {
      if (t < 0 || s.triangle_stamp_[t] == s.stamp_) continue;
      s.triangle_stamp_[t] = s.stamp_;
      s.triangles_.push_back(t);
    }
  }

  s.quantities_ = kQuantities[derivatives];
  s.lanes_ = lanes;
  const int per_triangle = num_multi_indices<2>(degree_);
  const std::size_t per_slot = static_cast<std::size_t>(s.quantities_) * lanes / 4;
  const std::size_t most = s.triangles_.size() * per_triangle * per_slot;
  if (s.sums_.size() < most) s.sums_.resize(most);
  const auto triangle_kernel = avx2_ ? avx2::evaluate_triangle : baseline::evaluate_triangle;
  for (int t : s.triangles_) {
    const Triangle& triangle = triangles_[t];
    const LaneEdgeValues* edges[3];
    for (int i = 0; i < 3; ++i) {
      const int e = triangle.edges[i];
      const int place = s.edge_stamp_[e] == s.stamp_ ? s.edge_place_[e] : -1;
      edges[i] = place >= 0 && s.edges_[place].nonzero ? &s.edges_[place].values : nullptr;
    }
    double* targets[21];
    const auto points_of_t = control_points_.of_simplex(t);
    for (int b = 0; b < per_triangle; ++b) {
      const std::size_t before = s.used_.size();
      const int slot = s.slot_of(points_of_t[b]);
      auto* first = &s.sums_[slot * per_slot];
      if (s.used_.size() > before) std::fill(first, first + per_slot, Scratch::Four{});
      targets[b] = first->v;
    }
    const unsigned found =
        triangle_kernel(triangle.kernel, points, degree_, derivatives, edges, targets);
    for (int b = 0; b < per_triangle; ++b) {
      if (found >> b & 1) s.nonzero_[s.point_slot_[points_of_t[b]]] = 1;
    }
  }
  s.found_.clear();
  s.slot_.clear();
  for (std::size_t slot = 0; slot < s.used_.size(); ++slot) {
    if (!s.nonzero_[slot]) continue;
    s.found_.push_back(s.used_[slot]);
    s.slot_.push_back(static_cast<int>(slot));
  }
}

}  // namespace crease
